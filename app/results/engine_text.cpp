#include "app/results/engine_text.h"

#include <iterator>

#include <fmt/format.h>

#include "app/results/report.h"

namespace hvp::results {

std::string clocks_text(const app::Scene& scene) {
  const fixed::Settings& solver = scene.scenario().solver;
  const accel::SolveCycles c = scene.solve_cycles();
  std::string text = fmt::format("\nClocks of a solve: {}\n", display_name(solver.method));
  const auto row = [&text](std::string_view what, std::int64_t clocks) {
    fmt::format_to(std::back_inserter(text), "  {:<34} {:>10}\n", what, clocks);
  };
  row("set-up", c.setup);
  row("an iteration", c.iteration());
  row("  product and inner product", c.sparse_product);
  row("  solution and residual", c.update);
  row("  direction", c.direction);
  row(scene.board().several() ? "  divisions, and sums over links"
                              : "  divisions that are waited for",
      c.divisions);
  if (c.replacements > 0) row("a residual formed anew", c.replacement);
  row(fmt::format("{}{} iterations", solver.stop_residual > 0 ? "at most " : "", c.iterations),
      c.total());
  return text;
}

std::string resources_text(const app::Scene& scene) {
  std::string text = fmt::format("\nMemory and multipliers of the {}{}\n",
                                 scene.board().several() ? "fullest " : "", scene.device().name);
  for (const accel::Resource& r : scene.usage().resources) {
    std::string uses;
    for (const accel::Allocation& a : scene.usage().allocations) {
      if (a.type != r.type) continue;
      uses += fmt::format("{}{} {}", uses.empty() ? "  " : ", ", a.use, a.blocks);
    }
    fmt::format_to(std::back_inserter(text), "  {:<12} {:>4} of {}{}\n", r.type, r.used,
                   r.available, uses);
  }
  return text;
}

}  // namespace hvp::results
