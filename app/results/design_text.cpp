#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "app/results/design_report.h"
#include "app/results/engine_text.h"
#include "app/results/number_text.h"
#include "app/results/report.h"
#include "app/results/several_text.h"
#include "app/scenario/message.h"
#include "models/time/picoseconds.h"

namespace hvp::results {

namespace {

using Out = std::back_insert_iterator<std::string>;

// Down, as the refusal of a clock has it: what is told can be set.
std::string megahertz(double hz) {
  return fmt::format("{:g} MHz", std::floor(hz * 1e-5 + 1e-9) / 10);
}

void head(Out out, const app::Scene& scene, const app::DesignFigures& f) {
  const app::Scenario& s = scene.scenario();
  const accel::Architecture& a = s.accelerator;
  if (!s.title.empty()) fmt::format_to(out, "{}\n", scenario::one_line(s.title, 1000));
  fmt::format_to(out, "  device      {}{} ({})\n",
                 a.several ? fmt::format("{} x ", a.several->devices) : "", scene.device().name,
                 scene.device().family);
  fmt::format_to(out, "  engine      {} rows x {} columns x {} partitions, {} node{} a clock\n",
                 a.rows_in_parallel, a.package, a.partitions, a.nodes_per_clock,
                 a.nodes_per_clock == 1 ? "" : "s");
  fmt::format_to(out, "  solver      {}, {} iterations, {}-bit matrix, {}-bit vectors\n",
                 display_name(s.solver.method), s.solver.iterations, s.solver.matrix_bits,
                 s.solver.vector_bits);
  fmt::format_to(out, "  system      {} nodes, {} non-zeros\n", scene.pattern().nodes(),
                 9 * scene.computation().matrix().blocks());
  fmt::format_to(out, "  clock       {}", megahertz(a.clock_hz));
  if (f.clock) {
    fmt::format_to(out, " of {} that the design reaches{}", megahertz(f.clock->highest_clock_hz),
                   f.clock_is_reached(a) ? "" : ": TOO FAST");
  }
  fmt::format_to(out, "\n");
  fmt::format_to(out, "  fit         {}\n",
                 f.usage.fits() ? "everything fits" : "DOES NOT FIT: see the table of memory");
}

// Which of an iteration's phases is the longest: what an architect looks at first.
void bottleneck(Out out, const accel::SolveCycles& c) {
  const std::int64_t vectors = c.update + c.direction;
  const auto share = [&c](std::int64_t clocks) {
    return 100.0 * static_cast<double>(clocks) / static_cast<double>(c.iteration());
  };
  fmt::format_to(
      out,
      "  of an iteration the product takes {:.0f} %, the vector unit {:.0f} %, divisions "
      "{:.0f} %\n",
      share(c.sparse_product), share(vectors), share(c.divisions));
}

void path_line(Out out, const char* what, const accel::Path& p) {
  fmt::format_to(out, "  {:<8} {:<40} {:>7.2f} ns\n", what, p.name, p.period_s() * 1e9);
}

void critical_path(Out out, const app::DesignFigures& f) {
  if (!f.clock) {
    fmt::format_to(out, "\nCritical path: the device's file has no [timing]\n");
    return;
  }
  const std::vector<accel::Path>& paths = f.clock->paths;
  fmt::format_to(out, "\nCritical path: {}\n", megahertz(f.clock->highest_clock_hz));
  path_line(out, "longest", paths.front());
  for (const accel::Element& e : paths.front().elements) {
    fmt::format_to(out, "             {:<36} {:>7.2f} ns\n", accel::text(e), e.delay_s * 1e9);
  }
  constexpr std::size_t kNext = 4;
  for (std::size_t i = 1; i < std::min(paths.size(), kNext + 1); ++i) {
    path_line(out, "then", paths[i]);
  }
}

// What no block of the chosen type can do, which the counts of blocks do not show.
void obstacles(Out out, const accel::Usage& usage) {
  for (const accel::Obstacle& o : usage.obstacles) {
    fmt::format_to(out, "  DOES NOT FIT: {} (accelerator.{})\n", o.reason, o.key);
  }
}

void packing(Out out, const accel::Packing& p) {
  fmt::format_to(
      out,
      "  padding: {:.1f} % more words than non-zeros; the fullest partition has {:.1f} % "
      "more packages than the mean\n",
      100 * p.loss(), 100 * p.balance.loss());
}

void operations(Out out, const accel::OperationRate& r) {
  fmt::format_to(out, "\nOperations a second\n");
  const auto row = [out](const char* what, double rate) {
    fmt::format_to(out, "  {:<44} {:>7.2f} GOPS\n", what, rate * 1e-9);
  };
  row("thesis' convention, 36 a partition and clock", r.thesis);
  row("all multipliers busy", r.peak);
  row("the product: non-zeros only", r.product);
  row("the whole solve", r.solve);
}

void reach_line(Out out, const char* what, const app::Reach& r) {
  fmt::format_to(out, "  {:<12} {:>6} nodes, {:>6} in the system", what, r.mesh_nodes, r.nodes);
  if (r.solve_ps > 0) {
    fmt::format_to(out, "   solve {:>8}, {:>5.0f} Hz   frame {:>8}, {:>5.0f} Hz",
                   readable_time(r.solve_ps), r.solve_rate_hz(), readable_time(r.frame_ps),
                   r.frame_rate_hz());
  }
  fmt::format_to(out, "\n");
}

void reach(Out out, const accel::Architecture& a, const app::DesignFigures& f) {
  fmt::format_to(out,
                 "\nLargest mesh and highest rate, with rows like these and as many iterations{}\n",
                 f.clock_is_reached(a) ? "" : ", at " + megahertz(f.clock->highest_clock_hz));
  reach_line(out, "this mesh", f.scene);
  if (f.largest) {
    reach_line(out, "largest", *f.largest);
  } else {
    fmt::format_to(out, "  largest      none fits\n");
  }
}

std::string fit_text(const app::WhatIf& w) {
  if (w.short_of.empty()) return "fits";
  return fmt::format("{}", fmt::join(w.short_of, ", "));
}

void what_if(Out out, const app::DesignFigures& f) {
  fmt::format_to(out, "\n{:<58} {:>8} {:>9} {:>8}\n", "If one number changes", "clocks", "highest",
                 "solve");
  for (const app::WhatIf& w : f.what_if) {
    const std::string change =
        fmt::format("{}{} {} -> {}", w.variation.key, w.variation.numbers ? "*" : "",
                    w.variation.from, w.variation.to);
    if (!w.refused.empty()) {
      fmt::format_to(out, "  {:<56} {}\n", change, w.refused);
      continue;
    }
    fmt::format_to(out, "  {:<56} {:>8} {:>9} {:>8}   {}\n", change, w.solve_clocks,
                   w.highest_clock_hz ? megahertz(*w.highest_clock_hz) : "",
                   readable_time(to_picoseconds(w.solve_s)), fit_text(w));
  }
  fmt::format_to(out, "  * the solver's words change too, and with them its accuracy\n");
}

}  // namespace

std::string design_text(const app::Scene& scene, const app::DesignFigures& f) {
  std::string text;
  const Out out = std::back_inserter(text);
  head(out, scene, f);
  text += clocks_text(scene);
  bottleneck(out, f.cycles);
  critical_path(out, f);
  text += several_text(scene);
  text += resources_text(scene);
  obstacles(out, f.usage);
  packing(out, f.packing);
  operations(out, f.operations);
  reach(out, scene.scenario().accelerator, f);
  what_if(out, f);
  return text;
}

}  // namespace hvp::results
