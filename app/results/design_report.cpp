#include "app/results/design_report.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include <fmt/format.h>

#include "app/results/number_text.h"
#include "app/results/report.h"
#include "app/results/scene_figures.h"
#include "app/scenario/message.h"
#include "app/scene/scene.h"
#include "models/time/picoseconds.h"

namespace hvp::results {

namespace {

constexpr std::string_view kClocks = "clocks";

void report_cycles(config::Figures& f, const accel::SolveCycles& c) {
  const auto clocks = [&f](std::string_view key, std::int64_t count, std::string_view help) {
    f.value(key, count, kClocks, help);
  };
  clocks("setup", c.setup, "until the first iteration");
  clocks("iteration", c.iteration(), "of one iteration, all groups");
  clocks("sparse_product", c.sparse_product, "its group a: the product and its inner product");
  clocks("update", c.update, "its group b: solution and residual");
  clocks("direction", c.direction, "its group c");
  clocks("divisions", c.divisions, "its divisions, as far as they are waited for");
  f.count("iterations", c.iterations, "a solve");
  clocks("replacement", c.replacement, "one residual formed anew, beyond its iteration");
  f.count("replacements", c.replacements, "a solve");
  clocks("solve", c.total(), "of all");
}

void report_path(config::Figures& f, const accel::Path& p) {
  f.text("name", p.name, "from a register to the next one");
  f.quantity("period_ns", p.period_s() * 1e9, "ns", "the shortest period that it allows");
  f.list("elements", "What it passes.", p.elements, [&f](const accel::Element& e) {
    f.text("element", accel::text(e), "its kind and size");
    f.quantity("ns", e.delay_s * 1e9, "ns", "what it takes");
  });
}

void report_resource(config::Figures& f, const accel::Resource& r, const accel::Usage& usage) {
  f.text("type", r.type, "a memory, `multipliers`, `logic` or `registers`");
  f.count("used", r.used, "how many the design takes");
  f.count("available", r.available, "how many the device has");
  std::vector<accel::Allocation> uses;
  for (const accel::Allocation& a : usage.allocations) {
    if (a.type == r.type) uses.push_back(a);
  }
  f.list("uses", "What for.", uses, [&f](const accel::Allocation& a) {
    f.text("use", a.use, "a structure of the engine");
    f.count("blocks", a.blocks, "that it takes");
  });
}

void report_reach(config::Figures& f, const app::Reach& r) {
  const bool solved = r.solve_ps > 0;
  const auto number = [solved](double value) {
    return solved ? std::optional(value) : std::nullopt;
  };
  f.count("nodes", r.nodes, "in the system");
  f.count("mesh_nodes", r.mesh_nodes, "of the mesh, as `object.mesh.nodes` has them");
  f.quantity("solve_us", number(static_cast<double>(r.solve_ps) / 1e6), config::kMicroseconds,
             "of a solve; null where nothing is solved");
  f.quantity("solve_rate_hz", number(solved ? r.solve_rate_hz() : 0), "Hz",
             "solves one after the other; likewise");
  f.quantity("frame_us", number(static_cast<double>(r.frame_ps) / 1e6), config::kMicroseconds,
             "the frame's large steps one after the other, by annotated costs; likewise");
  f.quantity("frame_rate_hz", number(solved ? r.frame_rate_hz() : 0), "Hz", "likewise");
}

void report_what_if(config::Figures& f, const app::WhatIf& w) {
  f.text("key", w.variation.key, "that is changed, alone");
  f.text("from", w.variation.from, "the scenario's value");
  f.text("to", w.variation.to, "another");
  f.truth("changes_words", w.variation.numbers, "the words that a solve gives change too");
  f.when(w.refused.empty(), [&] {
    f.count("solve_cycles", w.solve_clocks, "clocks of a solve then");
    f.quantity("highest_hz", w.highest_clock_hz, "Hz",
               "the highest clock then; null where the device's file has no `[timing]`");
    f.quantity("solve_us", w.solve_s * 1e6, config::kMicroseconds,
               "of a solve then, at the scenario's clock or the highest where that is lower");
    f.truth("fits", w.short_of.empty(), "whether the device holds it");
    f.value("short_of", w.short_of, {}, "what there is not enough of");
  });
  f.when(!w.refused.empty(),
         [&] { f.text("refused", w.refused, "instead: why there is no such design"); });
}

}  // namespace

DesignReport design_report(const app::Scene& scene, const app::DesignFigures& figures) {
  const app::Scenario& s = scene.scenario();
  DesignReport r{.title = s.title,
                 .device = scene.device().name,
                 .family = scene.device().family,
                 .clock_hz = s.accelerator.clock_hz,
                 .clock_is_reached = figures.clock_is_reached(s.accelerator),
                 .devices = s.accelerator.several ? s.accelerator.several->devices : 1,
                 .links = std::nullopt,
                 .figures = figures};
  if (const std::optional<accel::SeveralDevices>& several = scene.board().several()) {
    const accel::SeveralCycles c =
        several->solve(accel::longest_solve(scene.computation().board().settings()));
    r.links = {c.link_clocks_an_iteration(), c.link_clocks()};
  }
  return r;
}

void DesignReport::report(config::Figures& f) const {
  const app::DesignFigures& d = figures;
  f.text("title", title, "the scenario's own line, with what `--set` changes in brackets");
  f.table("device", "The FPGA.", [&] {
    f.text("name", device, "its name");
    f.text("family", family, "its family");
  });
  f.truth("fits", d.usage.fits(), "whether the device holds the system");
  f.table("cycles", "Clocks of a solve that makes all its iterations, by the closed form.",
          [&] { report_cycles(f, d.cycles); });
  f.table("clock", "The engine's clock.", [&] {
    f.quantity("hz", clock_hz, "Hz", "the scenario's");
    f.quantity("highest_hz", d.clock ? std::optional(d.clock->highest_clock_hz) : std::nullopt,
               "Hz",
               "what the longest path allows; null where the device's file has no `[timing]`");
    f.truth("reached", clock_is_reached, "whether the scenario's is no higher");
    f.list("paths", "The one that limits the clock first.",
           d.clock ? d.clock->paths : std::vector<accel::Path>(),
           [&f](const accel::Path& p) { report_path(f, p); });
  });
  f.list("resources", "Memory, multipliers and logic.", d.usage.resources,
         [&](const accel::Resource& r) { report_resource(f, r, d.usage); });
  f.list("obstacles", "Structures that the chosen memory cannot serve at all.", d.usage.obstacles,
         [&f](const accel::Obstacle& o) {
           f.text("key", "accelerator." + o.key, "that chose it");
           f.text("reason", o.reason, "why not");
         });
  f.count("devices", devices, "that share the rows");
  f.if_present(links, [&](const Links& l) {
    f.table("links", "With `[accelerator.several]` only: what the links add.", [&] {
      f.value("clocks_an_iteration", l.clocks_an_iteration, kClocks, "to an iteration");
      f.value("clocks_a_solve", l.clocks_a_solve, kClocks, "to a solve");
    });
  });
  f.table("packing", "How the matrix lies in its memories.", [&] {
    f.count("nonzeros", d.packing.nonzeros, "words of the matrix that are stored");
    f.count("stored", d.packing.stored, "with the padding of the packages");
    f.ratio("padding_rel", d.packing.loss(), "padding over non-zeros");
    f.ratio("imbalance_rel", d.packing.balance.loss(), "what the partitions' imbalance costs");
  });
  f.table("operations_per_s", "Arithmetic.", [&] {
    f.quantity("thesis", d.operations.thesis, "flop/s", "by the thesis' rule, for comparisons");
    f.quantity("peak", d.operations.peak, "flop/s", "every multiplier of the product, each clock");
    f.quantity("product", d.operations.product, "flop/s", "of the product over its clocks");
    f.quantity("solve", d.operations.solve, "flop/s", "of all iterations over those of the solve");
  });
  f.table("mesh", "The scenario's mesh.", [&] { report_reach(f, d.scene); });
  f.table_or_null("largest_mesh", "The largest of such rows that fits; null where none does.",
                  d.largest, [&f](const app::Reach& r) { report_reach(f, r); });
  f.list("what_if", "One number of the design changed.", d.what_if,
         [&f](const app::WhatIf& w) { report_what_if(f, w); });
}

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

// The longest of an iteration's phases, which an architect shortens first.
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

// Demands that no block of the chosen type can meet, which the counts of blocks do not show.
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
