#include "vp/fpga/rtl/engine_sizes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

namespace hvp::vp::rtl {

namespace {

// A larger memory or field serves as well, all else has to be equal.
enum class Serves { equal, larger };

struct Parameter {
  const char* name;    // in engine.sv
  const char* letter;  // in identifiers
  int EngineSize::*value;
  Serves serves;
};

constexpr std::array kParameters = {
    Parameter{"MatrixBits", "m", &EngineSize::matrix_bits, Serves::equal},
    Parameter{"VectorBits", "v", &EngineSize::vector_bits, Serves::equal},
    Parameter{"CoefficientBits", "c", &EngineSize::coefficient_bits, Serves::equal},
    Parameter{"Package", "w", &EngineSize::package, Serves::equal},
    Parameter{"Partitions", "p", &EngineSize::partitions, Serves::equal},
    Parameter{"Lanes", "l", &EngineSize::nodes_per_clock, Serves::equal},
    Parameter{"NodeBits", "n", &EngineSize::node_bits, Serves::larger},
    Parameter{"PackageBits", "k", &EngineSize::package_bits, Serves::larger},
    Parameter{"QueueBits", "q", &EngineSize::queue_bits, Serves::equal},
    Parameter{"PhaseClocks", "f", &EngineSize::phase_clocks, Serves::equal},
    Parameter{"DivisionClocks", "d", &EngineSize::division_clocks, Serves::equal},
    Parameter{"StaticBits", "s", &EngineSize::static_bits, Serves::larger},
    Parameter{"RowsInParallel", "r", &EngineSize::rows_in_parallel, Serves::equal},
    Parameter{"DirectionBanks", "b", &EngineSize::direction_banks, Serves::equal},
};

// As the build names it.
const char* parameter(accel::DirectionMemory memory) {
  switch (memory) {
    case accel::DirectionMemory::double_pumped:
      return "double_pumped";
    case accel::DirectionMemory::two_copies:
      return "two_copies";
    default:
      return "stall";
  }
}

// The bits that number so many things.
int bits_of(int count) {
  return static_cast<int>(std::bit_width(static_cast<std::uint32_t>(std::max(count, 1) - 1)));
}

bool serves(const EngineSize& size, const EngineSize& wanted) {
  return std::ranges::all_of(kParameters,
                             [&](const Parameter& p) {
                               const int has = size.*p.value;
                               const int asked = wanted.*p.value;
                               return p.serves == Serves::equal ? has == asked : has >= asked;
                             }) &&
         size.direction_memory == wanted.direction_memory &&
         (size.preconditioner == wanted.preconditioner ||
          wanted.preconditioner == Preconditioner::none);
}

}  // namespace

Preconditioner preconditioner(fixed::Method method) {
  switch (method) {
    case fixed::Method::jacobi_pcg:
      return Preconditioner::jacobi;
    case fixed::Method::block_jacobi_pcg:
      return Preconditioner::blocks;
    default:
      return Preconditioner::none;
  }
}

EngineSize wanted_size(const accel::Architecture& a, const fixed::Settings& s, const Room& room) {
  // Those of the thesis' size and of the least that is tested: fewer bits save nothing.
  constexpr int kStaticBits = 4;
  constexpr int kAddressBits = 6;
  EngineSize size{};
  size.name = "";
  size.matrix_bits = s.matrix_bits;
  size.vector_bits = s.vector_bits;
  size.coefficient_bits = s.coefficient_bits;
  size.package = a.package;
  size.partitions = a.partitions;
  size.nodes_per_clock = a.nodes_per_clock;
  // A bank of d has two nodes at least.
  size.node_bits = std::max({kAddressBits, bits_of(room.nodes), bits_of(a.direction_banks) + 1});
  size.package_bits = std::max(kAddressBits, bits_of(room.packages));
  size.queue_bits = bits_of(a.result_queue);
  size.phase_clocks = a.phase_clocks();
  size.division_clocks = static_cast<int>(a.division(s));
  // With the same words plain conjugate gradients may be asked of an engine with a preconditioner.
  constexpr int kLargestShift = 31;
  const int most_shift = std::max(s.rhs_shift(), std::min(s.shift(), kLargestShift));
  size.static_bits = std::max(
      kStaticBits, static_cast<int>(std::bit_width(static_cast<std::uint32_t>(most_shift))));
  size.rows_in_parallel = a.rows_in_parallel;
  size.direction_banks = a.direction_banks;
  size.direction_memory = a.direction_memory;
  size.preconditioner = preconditioner(s.method);
  return size;
}

const EngineSize* find_size(const EngineSize& wanted) {
  for (const EngineSize* size : engine_sizes()) {
    if (serves(*size, wanted)) return size;
  }
  return nullptr;
}

std::string parameters(const EngineSize& size) {
  std::string text;
  for (const Parameter& p : kParameters) {
    text += std::string(p.name) + " " + std::to_string(size.*p.value) + " ";
  }
  return text + "DirectionMemory " + parameter(size.direction_memory) + " Preconditioner " +
         std::to_string(static_cast<int>(size.preconditioner));
}

std::string identifier(const EngineSize& size) {
  constexpr std::array kEndings = {"", "_jacobi", "_blocks"};
  std::string text;
  for (const Parameter& p : kParameters) text += p.letter + std::to_string(size.*p.value);
  return text + "_" + parameter(size.direction_memory) +
         kEndings[static_cast<std::size_t>(size.preconditioner)];
}

}  // namespace hvp::vp::rtl
