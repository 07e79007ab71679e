#include "tables/synthesis/measured.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>

#include "app/devices/devices.h"
#include "models/accel/engine_logic.h"
#include "models/files/csv.h"

namespace hvp::tables {

namespace {

// engine.sv holds rows of as many blocks.
constexpr int kLongestRow = 1 << accel::kRowBlockBits;
// Blocks of a synthesis without a unit of their own name in the model: what others leave over.
constexpr std::string_view kInSequencer[] = {"divider", "scaler", "stop test"};

int number(const files::CsvTable& table, std::string_view column) {
  return table.number<int>(table.column(column));
}

// 0 for an empty field.
double real(const files::CsvTable& table, std::string_view column) {
  const std::size_t at = table.column(column);
  return table.text(at).empty() ? 0 : table.number<double>(at);
}

SynthesisedEngine engine_of(const files::CsvTable& row) {
  SynthesisedEngine e;
  e.name = row.text(row.column("engine"));
  e.calibrates = number(row, "calibrates") != 0;
  accel::Architecture& a = e.architecture;
  a.device = "LFE5U-85F";
  a.package = number(row, "Package");
  a.partitions = number(row, "Partitions");
  a.nodes_per_clock = number(row, "Lanes");
  a.rows_in_parallel = number(row, "RowsInParallel");
  a.result_queue = 1 << number(row, "QueueBits");
  a.pipeline_clocks = number(row, "PhaseClocks");
  a.division_clocks = number(row, "DivisionClocks");
  a.direction_banks = number(row, "DirectionBanks");
  a.parity_bits = true;  // the tools use them
  a.direction_memory = static_cast<accel::DirectionMemory>(number(row, "DirectionMemory"));
  accel::WordLengths& w = e.words;
  w.matrix_bits = number(row, "MatrixBits");
  w.vector_bits = number(row, "VectorBits");
  w.coefficient_bits = number(row, "CoefficientBits");
  constexpr fixed::Method kMethods[] = {fixed::Method::cg, fixed::Method::jacobi_pcg,
                                        fixed::Method::block_jacobi_pcg};
  w.method = kMethods[std::clamp(number(row, "Preconditioner"), 0, 2)];
  w.extrapolated = true;
  w.stop_test = true;
  e.size.nodes = 1 << number(row, "NodeBits");
  e.size.direction_nodes = e.size.nodes;
  e.size.packages = std::int64_t{1} << number(row, "PackageBits");
  e.size.longest_row = kLongestRow;
  return e;
}

SynthesisedBlock block_of(const files::CsvTable& row) {
  SynthesisedBlock b;
  b.name = row.text(row.column("block"));
  b.count = number(row, "count");
  b.cells = number(row, "luts") + 2 * number(row, "carries");
  b.registers = number(row, "registers");
  b.memories = number(row, "memories");
  b.distributed = number(row, "ram");
  b.multipliers = number(row, "multipliers");
  b.clock_mhz = real(row, "clock_mhz");
  b.path = row.text(row.column("path"));
  b.half_clock_ns = real(row, "half_clock_ns");
  b.half_path = row.text(row.column("half_path"));
  return b;
}

std::ifstream opened(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error("cannot read " + file);
  return stream;
}

double counted_cells(const std::vector<accel::LogicUse>& uses, std::string_view unit) {
  const auto found = std::ranges::find(uses, unit, &accel::LogicUse::unit);
  return found == uses.end() ? 0 : static_cast<double>(found->count * found->counted.tables);
}

// The sequencer is synthesised with three units that stand for themselves in the model, a partition
// with the banks of d that it deals nodes to, of which the model says what is left without them;
// and what lies between the units is what the whole engine has more than all of them.
double measured_cells(const SynthesisedEngine& e, const std::vector<accel::LogicUse>& uses,
                      std::string_view unit) {
  const auto cells = [&](std::string_view name) {
    const SynthesisedBlock* block = e.block(name);
    return block == nullptr ? 0 : block->count * block->cells;
  };
  if (unit == "sequencer") {
    int own = cells(unit);
    for (const std::string_view name : kInSequencer) own -= cells(name);
    return own;
  }
  if (unit == "banks of d") {
    const auto partition = std::ranges::find(uses, "partition", &accel::LogicUse::unit);
    return cells("partition") - partition->cells();
  }
  if (unit != "between") return cells(unit);
  int rest = e.whole().cells;
  for (const SynthesisedBlock& b : e.blocks) {
    const bool inside = std::ranges::find(kInSequencer, b.name) != std::end(kInSequencer);
    if (b.name != "engine" && !inside) rest -= b.count * b.cells;
  }
  return rest;
}

}  // namespace

const SynthesisedBlock* SynthesisedEngine::block(std::string_view wanted) const {
  const auto found = std::ranges::find(blocks, wanted, &SynthesisedBlock::name);
  return found == blocks.end() ? nullptr : &*found;
}

const SynthesisedBlock& SynthesisedEngine::whole() const {
  const SynthesisedBlock* found = block("engine");
  if (found == nullptr) throw std::runtime_error("measured.csv has no whole engine " + name);
  return *found;
}

std::vector<SynthesisedEngine> synthesised_engines(const std::string& folder) {
  std::vector<SynthesisedEngine> engines;
  std::ifstream sizes = opened(folder + "/engines.csv");
  files::CsvTable engine(sizes, "engines.csv");
  while (engine.next()) engines.push_back(engine_of(engine));
  std::ifstream figures = opened(folder + "/measured.csv");
  files::CsvTable block(figures, "measured.csv");
  while (block.next()) {
    const std::string_view name = block.text(block.column("engine"));
    const auto found = std::ranges::find(engines, name, &SynthesisedEngine::name);
    if (found == engines.end()) {
      throw InputError(block.where() + ": engines.csv has no engine " + std::string(name));
    }
    found->blocks.push_back(block_of(block));
  }
  return engines;
}

double fitted_coefficient(const std::vector<SynthesisedEngine>& engines, std::string_view unit) {
  double measured = 0;
  double counted = 0;
  for (const SynthesisedEngine& e : engines) {
    if (!e.calibrates) continue;
    const std::vector<accel::LogicUse> uses =
        accel::logic(devices::built_in(e.architecture.device), e.architecture, e.words, e.size);
    const double tables = counted_cells(uses, unit);
    const bool with_banks = counted_cells(uses, "banks of d") > 0;
    if (tables <= 0 || (unit == "partition" && with_banks)) continue;
    measured += measured_cells(e, uses, unit);
    counted += tables;
  }
  return counted > 0 ? measured / counted : 0;
}

}  // namespace hvp::tables
