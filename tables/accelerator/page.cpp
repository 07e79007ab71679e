#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "app/devices/devices.h"
#include "models/accel/critical_path.h"
#include "models/accel/memory.h"
#include "models/accel/operations.h"
#include "tables/pages.h"
#include "tables/text.h"

namespace hvp::tables {

namespace {

using accel::Architecture;
using accel::Device;
using accel::Pattern;
using accel::WordLengths;

constexpr int kThesisNodes = 500;

// Rows of 36 non-zeros, the thesis' mean (§5.4): 12 blocks, five packages of eight columns.
Pattern thesis_rows(int nodes) { return {std::vector<int>(static_cast<std::size_t>(nodes), 12)}; }

int used(const accel::Usage& usage, std::string_view type) {
  for (const accel::Resource& r : usage.resources) {
    if (r.type == type) return r.used;
  }
  return 0;
}

std::string deviation(double ours, double theirs) {
  return fmt::format("{:+.1f} %", 100 * (ours - theirs) / theirs);
}

std::string table_5_1() {
  const Device& d = devices::built_in("EP2S60");
  MarkdownTable table({"", "thesis", "devices/EP2S60.toml"});
  const auto memory = [&](const char* type, int thesis) {
    table.add({type, std::to_string(thesis), std::to_string(d.memory(type)->blocks)});
  };
  memory("M512", 329);
  memory("M4K", 255);
  memory("M-RAM", 2);
  table.add({"multipliers 18 × 18", "144", std::to_string(d.multipliers.front().count)});
  return table.text();
}

std::string table_6_1() {
  MarkdownTable table({"PL3", "multipliers: 24·PL3", "model", "thesis: 36·PL3 a clock, GOPS",
                       "all multipliers busy", "non-zeros of 500 nodes, in the product",
                       "the whole solve"});
  for (const int partitions : {1, 2, 5, 14, 16, 32}) {
    Architecture a;
    a.partitions = partitions;
    const Pattern p = thesis_rows(kThesisNodes);
    const accel::OperationRate r =
        accel::operation_rate(a, p, fixed::Method::cg, accel::solve_cycles(a, p, {}));
    const auto gops = [](double rate) { return fmt::format("{:.1f}", rate * 1e-9); };
    table.add({std::to_string(partitions), std::to_string(24 * partitions),
               std::to_string(a.rows_in_parallel * a.package * partitions), gops(r.thesis),
               gops(r.peak), gops(r.product), gops(r.solve)});
  }
  return table.text();
}

std::string table_6_2() {
  const Architecture a;
  const Device& d = devices::built_in("EP2S60");
  const accel::Usage usage = accel::usage(d, a, WordLengths{}, thesis_rows(kThesisNodes));
  MarkdownTable table({"", "thesis", "model", "deviation"});
  const auto row = [&](const char* what, double thesis, double model) {
    table.add(
        {what, fmt::format("{:g}", thesis), fmt::format("{:g}", model), deviation(model, thesis)});
  };
  row("combinational ALUTs", 8400, used(usage, "logic"));
  row("registers", 10500, used(usage, "registers"));
  row("M4K", 251, used(usage, "M4K"));
  row("M-RAM", 2, used(usage, "M-RAM"));
  row("multipliers", 141, used(usage, "multipliers"));
  const double clock = accel::highest_clock({d, a, WordLengths{}, kThesisNodes});
  row("clock, MHz", 100, std::round(clock * 1e-5) / 10);
  return table.text();
}

// The resources that a device lacks for one more partition.
std::string limit(const Device& d, Architecture a, const Pattern& p) {
  ++a.partitions;
  std::string types;
  for (const accel::Resource& r : accel::usage(d, a, WordLengths{}, p).resources) {
    if (r.used > r.available) types += (types.empty() ? "" : ", ") + r.type;
  }
  return types;
}

int most_partitions(const Device& d, Architecture a, const Pattern& p) {
  constexpr int kMost = 256;  // that a scenario may ask for
  a.partitions = 0;
  while (a.partitions < kMost) {
    Architecture more = a;
    ++more.partitions;
    if (!accel::usage(d, more, WordLengths{}, p).fits()) break;
    a = more;
  }
  return a.partitions;
}

std::string table_6_4() {
  struct Row {
    const char* device;
    int partitions;
  };
  constexpr std::array<Row, 5> kThesis = {
      {{"EP2S60", 5}, {"EP2S180", 14}, {"EP3SL150", 14}, {"EP3SE110", 32}, {"EP3SE260", 28}}};
  MarkdownTable table({"device", "multipliers", "⌊0.875·multipliers/24⌋", "thesis' PL3",
                       "model's PL3, 500 nodes", "what limits it", "most nodes at the thesis' PL3",
                       "most nodes at the model's PL3"});
  const Pattern p = thesis_rows(kThesisNodes);
  for (const Row& row : kThesis) {
    const Device& d = devices::built_in(row.device);
    for (const accel::MultiplierMode& mode : d.multipliers) {
      Architecture a;
      a.multiplier_mode = mode.name;
      Architecture ours = a;
      a.partitions = row.partitions;
      ours.partitions = most_partitions(d, ours, p);
      const int nodes = accel::largest_mesh(d, a, WordLengths{}, p);
      table.add({row.device, fmt::format("{} as {}", mode.count, mode.name),
                 std::to_string(mode.count * 7 / 8 / 24), std::to_string(row.partitions),
                 std::to_string(ours.partitions), limit(d, ours, p),
                 nodes > 0 ? std::to_string(nodes) : "none",
                 std::to_string(accel::largest_mesh(d, ours, WordLengths{}, p))});
    }
  }
  return table.text();
}

}  // namespace

std::string accelerator_page() {
  std::string text = R"(# Tables 5.1, 6.1, 6.2 and 6.4 of the thesis

<!-- Made by `./hvp tables accelerator > docs/accelerator-tables.md`: do not edit. -->

The thesis' figures beside what `models/accel` gives for the same design: 500 nodes with 36
non-zeros a row (§5.4), PL1 = 3, PL2 = 8, plain CG, 12-bit matrix, 16-bit vectors, 100 MHz. Table 6.3
depends on the machine that measures it: `--measure` prints it too ([accelerator.md](accelerator.md)).

<!-- not run: writes into the checkout -->
```sh
./hvp tables accelerator > docs/accelerator-tables.md
./hvp tables accelerator --measure
```

## Table 5.1: what an EP2S60 has

)";
  text += table_5_1();
  text += R"(
## Table 6.1: operations a second and multipliers

)" + table_6_1();
  text += R"(
The multipliers agree. The rate does not: 24 multipliers and their adders are 48 operations a clock
and partition, not 36; no count of the design gives 36. What a product really does is less than all
multipliers busy, because rows are padded to whole packages and the pipeline has to fill; from some
PL3 on it stands still, because the vector unit takes no more than L = 2 finished rows a clock. What the
whole solve does is less again, because the multipliers of SpMxV rest while the vectors are updated.

## Table 6.2: what the design takes

)" + table_6_2();
  text += R"(
- *M4K.* The model counts the matrix, one copy of d for each partition, x, b, r and A·d. The thesis
  does not list what it stores; 11 blocks more are a second buffer for b, U or both (6 each), or
  FIFOs towards the PCI core.
- *ALUTs and registers* are the count of the engine in SystemVerilog
  ([accelerator.md](accelerator.md)) times Stratix II's shares, which are calibrated on this table; PCI
  core and driver logic are not in it.
- *Clock.* The model's is what its critical path allows, [critical-path.md](critical-path.md); it is
  calibrated on this one figure for Stratix II.

## Table 6.4: partitions by device

)" + table_6_4();
  text += R"(
The thesis' PL3 is a bound by multipliers with a reserve of an eighth, exactly: the third column, with
the multipliers of Stratix III at their full number, which they have only where products are summed in
a block (`accelerator.multiplier_mode`). It forgets memory: every partition needs a copy of d and whole
blocks for its part of the matrix, so that more partitions can mean fewer nodes. The model takes no
reserve, but its vector unit takes 21 multipliers.
)";
  return text;
}

}  // namespace hvp::tables
