#include "app/results/several_text.h"

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <vector>

#include <fmt/format.h>

namespace hvp::results {

std::string several_text(const app::Scene& scene) {
  const std::optional<accel::SeveralDevices>& several = scene.board().several();
  if (!several) return {};
  const accel::Architecture& a = scene.scenario().accelerator;
  const accel::SolveWork work = accel::longest_solve(scene.computation().board_settings());
  const accel::SeveralCycles c = several->solve(work);
  std::string text = "\nSeveral devices\n";
  const auto out = std::back_inserter(text);
  const std::vector<accel::DeviceShare>& shares = several->shares();
  for (std::size_t d = 0; d < shares.size(); ++d) {
    fmt::format_to(out, "  device {:<27} {:>10} nodes' rows; vectors of {} nodes, {} of others'\n",
                   d + 1, shares[d].pattern.nodes(), shares[d].pattern.nodes_in_vectors(),
                   shares[d].halo);
  }
  const auto row = [&out](const char* what, std::int64_t clocks) {
    fmt::format_to(out, "  {:<34} {:>10}\n", what, clocks);
  };
  row("clocks of links an iteration", c.link_clocks_an_iteration());
  row("  before the product or behind it", c.solve.sparse_product - c.alone.sparse_product);
  row("  sums", c.solve.divisions - c.alone.divisions);
  row("clocks of links a solve", c.link_clocks());
  fmt::format_to(out, "  {:<34}", "speed-up over one device");
  for (const accel::Scaling& s : accel::scaling(a, scene.pattern(), work, 8)) {
    fmt::format_to(out, " {}: {:.2f}", s.devices, s.speed_up);
  }
  fmt::format_to(out, "\n  {:<34} {:>10.2f}\n", "  tends to, with free links",
                 accel::speed_up_limit(a, scene.pattern(), work));
  return text;
}

}  // namespace hvp::results
