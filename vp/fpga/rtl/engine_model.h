#pragma once

#include <cstdint>
#include <memory>

namespace hvp::vp::rtl {

// What the host can address in engine.sv (engine_types.sv, space_t).
enum class Space : std::uint8_t {
  settings,
  column,
  matrix,
  node,
  index,
  packages,
  x,
  b,
  place,
  contact,
  staged,
};

// The ports of engine.sv, the same for every size of the engine. Inputs hold until they are
// changed; outputs are those behind the last edge.
struct EnginePorts {
  bool reset = false;
  bool host_write = false;
  Space host_space = Space::settings;
  std::uint32_t host_address = 0;
  std::uint32_t host_word = 0;
  bool go = false;
  bool copy = false;
  bool invert = false;
  bool edit = false;
  bool forget_previous = false;

  std::int32_t host_read = 0;
  int state = 0;  // engine::State
  bool editing = false;
  bool finished = false;
  bool iteration_made = false;
  bool breakdown = false;
  bool reached = false;
  bool scalar_overflow = false;
  int iterations_made = 0;
  int replacements = 0;
  std::int64_t clamped = 0;
  std::int32_t alpha = 0;
  std::int32_t alpha_exponent = 0;  // of alpha * q, in units of r
  std::int32_t beta = 0;
  std::int32_t beta_exponent = 0;
  std::int32_t r_exponent = 0;
  std::int32_t z_exponent = 0;
  std::int32_t d_exponent = 0;
  std::int64_t z_r = 0;
  std::int64_t d_q = 0;
};

// engine.sv in one size, as Verilator has translated it.
class EngineModel {
 public:
  virtual ~EngineModel() = default;
  EngineModel() = default;
  EngineModel(const EngineModel&) = delete;
  EngineModel& operator=(const EngineModel&) = delete;

  // An edge of the clock.
  virtual void tick() = 0;
  // Lets the inputs act on the outputs without an edge.
  virtual void settle() = 0;

  EnginePorts ports;
};

// The size of an engine that was translated: the parameters of engine.sv.
struct EngineSize {
  const char* name;
  int matrix_bits;
  int vector_bits;
  int coefficient_bits;
  int package;
  int partitions;
  int nodes_per_clock;
  int node_bits;
  int package_bits;
  int queue_bits;
  int phase_clocks;
  int division_clocks;
  int static_bits;
  bool preconditioner;
  // All state begins with random values, which differ from seed to seed.
  std::unique_ptr<EngineModel> (*make)(int seed);

  static constexpr int kScalarBits = 64;
  static constexpr int kBlocksOfARow = 64;
  static constexpr int kPackagesOfARow = 255;
};

}  // namespace hvp::vp::rtl
