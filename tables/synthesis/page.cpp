#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "app/devices/devices.h"
#include "models/accel/critical_path.h"
#include "models/accel/engine_logic.h"
#include "models/accel/memory.h"
#include "tables/pages.h"
#include "tables/synthesis/measured.h"
#include "tables/text.h"

namespace hvp::tables {

namespace {

constexpr const char* kHead = R"(# What a synthesis makes of the engine

<!-- Made by `./hvp tables synthesis > docs/synthesis.md`: do not edit. -->

`vp/fpga/rtl/engine/` taken through open tools for ECP5 (yosys and nextpnr, speed grade 6, versions in
`tables/synthesis/versions.txt`), beside what `hvp device` says of the same engine. This command makes
a Python environment with the tools, measures what `tables/synthesis/measured.csv` does not have of
these sources, and prints this page; it takes some minutes for each engine whose sources have changed.

<!-- not run: minutes of synthesis, and writes into the checkout -->
```sh
./hvp tables synthesis > docs/synthesis.md
```

## The engines

`tables/synthesis/engines.csv` has their parameters. The model of the logic
([accelerator.md](accelerator.md#memory-and-multipliers)) has one coefficient a unit, fitted to the
engines that calibrate it; the others it has not seen. Memory, multipliers, registers and clocks are
fitted to none of them.

)";

std::string error(double model, double measured) {
  return fmt::format("{:+.1f} %", 100 * (model / measured - 1));
}

int used(const accel::Usage& usage, std::string_view type) {
  const auto found = std::ranges::find(usage.resources, type, &accel::Resource::type);
  return found == usage.resources.end() ? 0 : found->used;
}

std::string name_of(const SynthesisedEngine& e) {
  return e.calibrates ? e.name : "**" + e.name + "**";
}

std::string_view memories_of_d(accel::DirectionMemory kind) {
  switch (kind) {
    case accel::DirectionMemory::double_pumped:
      return "double-pumped";
    case accel::DirectionMemory::two_copies:
      return "two copies";
    case accel::DirectionMemory::stall:
      return "two ports";
  }
  return "";
}

std::string engines_table(const std::vector<SynthesisedEngine>& engines) {
  MarkdownTable table({"engine", "matrix, vector, coefficient bits", "package", "partitions",
                       "lanes", "nodes", "packages", "queue", "clocks of a pass", "rows at once",
                       "memories of d", "preconditioner", "calibrates"});
  for (const SynthesisedEngine& e : engines) {
    const accel::Architecture& a = e.architecture;
    const accel::WordLengths& w = e.words;
    table.add({name_of(e),
               fmt::format("{}, {}, {}", w.matrix_bits, w.vector_bits, w.coefficient_bits),
               fmt::format("{}", a.package), fmt::format("{}", a.partitions),
               fmt::format("{}", a.nodes_per_clock), fmt::format("{}", e.size.nodes),
               fmt::format("{}", e.size.packages), fmt::format("{}", a.result_queue),
               fmt::format("{}", a.pipeline_clocks), fmt::format("{}", a.rows_in_parallel),
               fmt::format("{} {}", a.direction_banks, memories_of_d(a.direction_memory)),
               w.preconditioned() ? "Jacobi" : "none", e.calibrates ? "yes" : "no"});
  }
  return table.text();
}

struct Figure {
  const char* what;
  int (*measured)(const SynthesisedBlock&);
  const char* resource;  // of accel::usage()
};

constexpr Figure kFigures[] = {
    {"look-up tables", [](const SynthesisedBlock& b) { return b.cells; }, "logic"},
    {"registers", [](const SynthesisedBlock& b) { return b.registers; }, "registers"},
    {"memory blocks (EBR)", [](const SynthesisedBlock& b) { return b.memories; }, "EBR"},
    {"memories in look-up tables (RAMW)", [](const SynthesisedBlock& b) { return b.distributed; },
     "RAMW"},
    {"multipliers", [](const SynthesisedBlock& b) { return b.multipliers; }, "multipliers"}};

std::string areas_table(const std::vector<SynthesisedEngine>& engines) {
  std::vector<std::string> heads = {"engine"};
  for (const Figure& figure : kFigures) {
    heads.insert(heads.end(), {figure.what, "`hvp device`", "error"});
  }
  MarkdownTable table(heads);
  for (const SynthesisedEngine& e : engines) {
    const accel::Usage usage =
        accel::usage(devices::built_in(e.architecture.device), e.architecture, e.words, e.size);
    std::vector<std::string> row = {name_of(e)};
    for (const Figure& figure : kFigures) {
      const int measured = figure.measured(e.whole());
      const int model = used(usage, figure.resource);
      row.insert(row.end(), {fmt::format("{}", measured), fmt::format("{}", model),
                             measured > 0 ? error(model, measured) : ""});
    }
    table.add(row);
  }
  return table.text();
}

std::string worst_errors(const std::vector<SynthesisedEngine>& engines) {
  std::string text;
  for (const Figure& figure : kFigures) {
    double worst = 0;
    for (const SynthesisedEngine& e : engines) {
      const accel::Usage usage =
          accel::usage(devices::built_in(e.architecture.device), e.architecture, e.words, e.size);
      const int measured = figure.measured(e.whole());
      if (e.calibrates || measured == 0) continue;
      const double off = 100.0 * used(usage, figure.resource) / measured - 100;
      if (std::abs(off) > std::abs(worst)) worst = off;
    }
    text += fmt::format("{}{} {:+.1f} %", text.empty() ? "" : ", ", figure.what, worst);
  }
  return text;
}

std::string units_table(const std::vector<SynthesisedEngine>& engines) {
  MarkdownTable table({"unit", "engine", "has of it", "look-up tables counted", "coefficient",
                       "fitted", "look-up tables", "registers"});
  std::vector<std::string_view> shown;
  for (const SynthesisedEngine& e : engines) {
    if (!e.calibrates) continue;
    for (const accel::LogicUse& use :
         accel::logic(devices::built_in(e.architecture.device), e.architecture, e.words, e.size)) {
      if (std::ranges::find(shown, use.unit) != shown.end()) continue;
      shown.push_back(use.unit);
      table.add({std::string(use.unit), e.name, fmt::format("{}", use.count),
                 fmt::format("{}", use.counted.tables), fmt::format("{:.2f}", use.coefficient),
                 fmt::format("{:.2f}", fitted_coefficient(engines, use.unit)),
                 fmt::format("{:.0f}", use.cells()), fmt::format("{}", use.registers())});
    }
  }
  return table.text();
}

std::string clocks_table(const SynthesisedEngine& e) {
  MarkdownTable table(
      {"block", "MHz", "longest path, from and to", "between the clocks, MHz", "its path"});
  for (const SynthesisedBlock& b : e.blocks) {
    if (b.clock_mhz <= 0) continue;
    const bool half = b.half_clock_ns > 0;
    table.add({b.name, fmt::format("{:.1f}", b.clock_mhz), "`" + b.path + "`",
               half ? fmt::format("{:.1f}", b.between_mhz()) : "",
               half ? "`" + b.half_path + "`" : ""});
  }
  return table.text();
}

std::string clocks(const std::vector<SynthesisedEngine>& engines) {
  MarkdownTable table({"engine", "slowest block", "its clock, MHz", "`hvp device`, MHz", "error",
                       "the model's longest path"});
  std::string each, worst;
  double most_off = 0;
  for (const SynthesisedEngine& e : engines) {
    const SynthesisedBlock* slowest = nullptr;
    for (const SynthesisedBlock& b : e.blocks) {
      if (b.clock_mhz <= 0) continue;
      if (slowest == nullptr || b.slowest_mhz() < slowest->slowest_mhz()) slowest = &b;
    }
    if (slowest == nullptr) continue;
    const accel::CriticalPath path = accel::critical_path(
        {devices::built_in(e.architecture.device), e.architecture, e.words, e.size.nodes});
    const double mhz = path.highest_clock_hz * 1e-6;
    table.add({name_of(e), slowest->name, fmt::format("{:.1f}", slowest->slowest_mhz()),
               fmt::format("{:.1f}", mhz), error(mhz, slowest->slowest_mhz()),
               std::string(path.paths.front().name)});
    each += fmt::format("\n### {}\n\n", e.name) + clocks_table(e);
    const double off = std::abs(mhz / slowest->slowest_mhz() - 1);
    if (off > most_off) {
      most_off = off;
      worst =
          fmt::format("\nLargest error: {} in {}.\n", error(mhz, slowest->slowest_mhz()), e.name);
    }
  }
  return table.text() + worst + each;
}

}  // namespace

std::string synthesis_page(const std::string& folder) {
  const std::vector<SynthesisedEngine> engines = synthesised_engines(folder);
  std::string page = kHead + engines_table(engines);
  page += R"(
## Area

Of the whole engine, before it is placed; bold names are engines that calibrate nothing. A cell of a
carry chain counts as the two look-up tables that it takes.

`hvp device` here is what it says of an LFE5U-85F with a stop test, the solution before x kept, and as
many nodes and packages as the engine has addresses for, because `engine.sv` has all of that in any
case. Of a scenario that asks for less it says less: without stop test and extrapolated start the
multipliers and memories of these are not in its figures. In none of them are contacts, places of rows
and the lists of the matrix editor and the multipliers of the scaler.

)";
  page += areas_table(engines);
  page +=
      "\nLargest errors over the engines that calibrate nothing: " + worst_errors(engines) + ".\n";
  page += R"(
### By units

What the model counts of one of each unit, in the first calibrating engine that has it, the coefficient
that this is multiplied by, and the one that the calibrating engines have together: measured look-up
tables over counted ones. The last two columns are of all of that unit. `between` is what the whole
engine has more than its units.
Registers are counted one by one and have no coefficient.

)";
  page += units_table(engines);
  page += R"(
## Clock

Blocks placed and routed, each by itself and with one seed: paths from and to a block's ports are not
among those that limit its clock. Paths between the engine's clock and the one of twice its frequency
have half a period: the slowest of both is the block's. No whole engine has been routed, and what
these have between their blocks is in no figure; engines that are not in the table are not placed.

)";
  page += clocks(engines);
  return page;
}

}  // namespace hvp::tables
