// What engine.sv is not built for: in one size, and in any.
#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

#include "models/config/input_error.h"
#include "models/fixed/division.h"
#include "vp/fpga/rtl/engine_sizes.h"
#include "vp/fpga/rtl/rtl_engine.h"

namespace hvp::vp::rtl {

namespace {

void require(bool there, const char* key, const std::string& found, const std::string& expected) {
  if (there) return;
  throw InputError(key, found + "; at the level rtl " + expected + " was expected");
}

const char* name(fixed::Method method) {
  switch (method) {
    case fixed::Method::cg:
      return "\"cg\"";
    case fixed::Method::jacobi_pcg:
      return "\"jacobi-pcg\"";
    case fixed::Method::block_jacobi_pcg:
      return "\"block-jacobi-pcg\"";
    case fixed::Method::chronopoulos_gear:
      return "\"chronopoulos-gear\"";
    default:
      return "\"pipelined-cg\"";
  }
}

const char* name(accel::DirectionMemory memory) {
  switch (memory) {
    case accel::DirectionMemory::double_pumped:
      return "\"double-pumped\"";
    case accel::DirectionMemory::two_copies:
      return "\"two-copies\"";
    default:
      return "\"stall\"";
  }
}

void require_equal(const char* key, int found, int expected) {
  require(found == expected, key, std::to_string(found), std::to_string(expected));
}

void require_at_most(const char* key, int found, int most) {
  require(found <= most, key, std::to_string(found), "at most " + std::to_string(most));
}

void require_at_least(const char* key, int found, int least) {
  require(found >= least, key, std::to_string(found), "at least " + std::to_string(least));
}

// The depths of pipelines that every size has.
void require_depths(const accel::Architecture& a) {
  require_equal("memory_read_clocks", a.memory_read_clocks, 2);
  require_equal("multiplier_clocks", a.multiplier_clocks, 3);
  require_equal("adder_tree_clocks", a.adder_tree_clocks, 4);
}

// What is the same in every size.
void require_arithmetic(const fixed::Settings& s) {
  require_equal("scalar_bits", s.scalar_bits, EngineSize::kScalarBits);
  require(s.coefficient_format == fixed::CoefficientFormat::own_shift, "coefficient_format",
          "\"fixed\"", "\"own-shift\"");
  require(s.overflow == fixed::Overflow::saturate, "overflow", "\"wrap\"", "\"saturate\"");
  // Without room for a vector that grows both terms of a sum can be beyond every word, and the
  // words of their sum need as many bits as the terms have.
  require(s.scaling_down || !s.dynamic_scaling, "scaling_down", "false", "true");
}

}  // namespace

// The conditions at the head of engine.sv, and what its host can address.
void require_buildable(const accel::Architecture& a) {
  constexpr int kLanes = 4;
  constexpr int kPartitions = 16;
  constexpr int kColumns = 16;
  constexpr int kRanks = 19;
  constexpr int kMostRanks = 256;  // delay lines that Verilator is told to unroll
  require_depths(a);
  require_at_most("nodes_per_clock", a.nodes_per_clock, kLanes);
  require_at_most("partitions", a.partitions, kPartitions);
  require_at_most("package", a.package, kColumns);
  require_at_least("result_queue", a.result_queue, 2);
  require(a.phase_clocks() >= kRanks, "pipeline_clocks", std::to_string(a.pipeline_clocks),
          "at least " + std::to_string(kRanks));
  require_at_most("pipeline_clocks", a.phase_clocks(), kMostRanks);
  require_at_least("direction_banks", a.direction_banks, a.nodes_per_clock / 2);
  const int nodes = a.package % 3 == 0 ? a.package / 3 : (a.package + 1) / 3 + 1;
  require(a.rows_in_parallel == 3 || nodes <= a.direction_accesses(), "rows_in_parallel",
          std::to_string(a.rows_in_parallel) + " with packages that touch " +
              std::to_string(nodes) + " nodes, of which a bank of d gives " +
              std::to_string(a.direction_accesses()) + " in a clock",
          "3");
}

void require_buildable(const fixed::Settings& s) {
  require_arithmetic(s);
  require(s.method == fixed::Method::cg || s.preconditioned(), "method", name(s.method),
          "\"cg\", \"jacobi-pcg\" or \"block-jacobi-pcg\"");
  // The host's register of the static shift has five bits.
  constexpr int kLargestShift = 31;
  require(s.rhs_shift() >= 0 && s.rhs_shift() <= kLargestShift, "static_shift",
          std::to_string(s.rhs_shift()), "at most " + std::to_string(kLargestShift));
}

void require_buildable(const accel::Architecture& a, const fixed::Settings& s) {
  // With z.r behind the last rank of a pass the divider begins later.
  constexpr int kRanksOfSums = 24;
  const int late = s.preconditioned() ? std::max(0, kRanksOfSums - a.phase_clocks()) : 0;
  int least = (s.scalar_bits - 1) / 8 + s.coefficient_bits + 41 + late;
  // So many divisions look up a node's row, of a package a clock, and make its words of P⁻¹.
  const int look_up = 14 + (3 * EngineSize::kBlocksOfARow + a.package - 1) / a.package;
  const int quotient = fixed::shortest_inverse_division(s);
  if (s.method == fixed::Method::jacobi_pcg) {
    least = std::max(least, (look_up + 3 * quotient + 2) / 3);
  }
  if (s.method == fixed::Method::block_jacobi_pcg) {
    // With blocks their products and rows, too.
    least = std::max(least, (look_up + 34 + 6 * (quotient - 2) + 5) / 6);
  }
  const auto given = static_cast<int>(a.division(s));
  require(given >= least, "division_clocks",
          a.division_clocks != 0 ? std::to_string(given)
                                 : "0, which is " + std::to_string(given) + " with these words",
          "at least " + std::to_string(least));
}

void require_buildable(const Room& room) {
  // Numbers of nodes and packages, as the host addresses them.
  require_at_most("nodes", room.nodes, 1 << 14);
  require_at_most("partitions", room.packages, 1 << 14);
}

void require_fitting(const EngineSize& size, const accel::Architecture& a) {
  require_equal("rows_in_parallel", a.rows_in_parallel, size.rows_in_parallel);
  require_equal("package", a.package, size.package);
  require_equal("partitions", a.partitions, size.partitions);
  require_equal("nodes_per_clock", a.nodes_per_clock, size.nodes_per_clock);
  require_depths(a);
  require_equal("pipeline_clocks", a.phase_clocks(), size.phase_clocks);
  if (a.division_clocks != 0) {
    require_equal("division_clocks", a.division_clocks, size.division_clocks);
  }
  require_equal("result_queue", a.result_queue, 1 << size.queue_bits);
  require_equal("direction_banks", a.direction_banks, size.direction_banks);
  require(a.direction_memory == size.direction_memory, "direction_memory", name(a.direction_memory),
          name(size.direction_memory));
}

void require_fitting(const EngineSize& size, const fixed::Settings& s) {
  constexpr std::array kMethods = {"\"cg\"", "\"cg\" or \"jacobi-pcg\"",
                                   "\"cg\" or \"block-jacobi-pcg\""};
  require(s.method == fixed::Method::cg ||
              (s.preconditioned() && preconditioner(s.method) == size.preconditioner),
          "method", name(s.method), kMethods[static_cast<std::size_t>(size.preconditioner)]);
  require_equal("matrix_bits", s.matrix_bits, size.matrix_bits);
  require_equal("vector_bits", s.vector_bits, size.vector_bits);
  require_equal("coefficient_bits", s.coefficient_bits, size.coefficient_bits);
  require_arithmetic(s);
  require(fixed::shortest_division(s) <= size.division_clocks, "scaling_step",
          std::to_string(s.scaling_step) + ", with which a division takes " +
              std::to_string(fixed::shortest_division(s)) + " clocks",
          "1, as its divisions have " + std::to_string(size.division_clocks) + ",");
  const int largest = (1 << size.static_bits) - 1;
  require(s.rhs_shift() >= 0 && s.rhs_shift() <= largest, "static_shift",
          std::to_string(s.rhs_shift()), "at most " + std::to_string(largest));
}

}  // namespace hvp::vp::rtl
