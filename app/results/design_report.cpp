#include "app/results/design_report.h"

#include <vector>

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
        several->solve(accel::longest_solve(scene.computation().board_settings()));
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

}  // namespace hvp::results
