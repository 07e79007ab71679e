// What engine.sv is not built for.
#include <string>

#include "models/config/input_error.h"
#include "models/fixed/division.h"
#include "vp/fpga/rtl/rtl_engine.h"

namespace hvp::vp::rtl {

namespace {

void require(bool there, const char* key, const std::string& found, const std::string& expected) {
  if (there) return;
  throw InputError(key, found + "; at the level rtl " + expected + " was expected");
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

}  // namespace

void require_fitting(const EngineSize& size, const accel::Architecture& a) {
  require_equal("rows_in_parallel", a.rows_in_parallel, size.rows_in_parallel);
  require_equal("package", a.package, size.package);
  require_equal("partitions", a.partitions, size.partitions);
  require_equal("nodes_per_clock", a.nodes_per_clock, size.nodes_per_clock);
  require_equal("memory_read_clocks", a.memory_read_clocks, 2);
  require_equal("multiplier_clocks", a.multiplier_clocks, 3);
  require_equal("adder_tree_clocks", a.adder_tree_clocks, 4);
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
  const bool jacobi = s.method == fixed::Method::jacobi_pcg;
  require(s.method == fixed::Method::cg || (jacobi && size.preconditioner), "method",
          "another method", size.preconditioner ? "\"cg\" or \"jacobi-pcg\"" : "\"cg\"");
  require_equal("matrix_bits", s.matrix_bits, size.matrix_bits);
  require_equal("vector_bits", s.vector_bits, size.vector_bits);
  require_equal("scalar_bits", s.scalar_bits, EngineSize::kScalarBits);
  require_equal("coefficient_bits", s.coefficient_bits, size.coefficient_bits);
  require(s.coefficient_format == fixed::CoefficientFormat::own_shift, "coefficient_format",
          "\"fixed\"", "\"own-shift\"");
  require(s.overflow == fixed::Overflow::saturate, "overflow", "\"wrap\"", "\"saturate\"");
  require(fixed::shortest_division(s) <= size.division_clocks, "scaling_step",
          std::to_string(s.scaling_step) + ", with which a division takes " +
              std::to_string(fixed::shortest_division(s)) + " clocks",
          "1, as its divisions have " + std::to_string(size.division_clocks) + ",");
  // Without room for a vector that grows both terms of a sum can be beyond every word, and the
  // words of their sum need as many bits as the terms have.
  require(s.scaling_down || !s.dynamic_scaling, "scaling_down", "false", "true");
  const int largest = (1 << size.static_bits) - 1;
  require(s.rhs_shift() >= 0 && s.rhs_shift() <= largest, "static_shift",
          std::to_string(s.rhs_shift()), "at most " + std::to_string(largest));
}

}  // namespace hvp::vp::rtl
