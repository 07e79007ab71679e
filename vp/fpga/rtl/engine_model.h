#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "models/accel/architecture.h"
#include "vp/fpga/rtl/shown_signals.h"

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
  // Clocks in which packages of any partition have waited since the solve began.
  std::int64_t turn_waits = 0;  // for the banks of d, or for their rows' turns
  std::int64_t room_waits = 0;  // for room for a finished row
};

// A memory, or a register of one word, as the translation stores it: words from address 0 on, each
// in `bytes`, with bit 0 first and the bits beyond `width` zero.
struct Cells {
  std::byte* first = nullptr;
  int count = 0;
  int width = 0;
  int bytes = 0;

  // Up to 32 bits of a word, from bit `low` on.
  std::uint32_t bits(int index, int low, int length) const;
  void set_bits(int index, int low, int length, std::uint32_t value) const;
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
  // The memory or register of an instance below engine.sv, "vectors.g_lane[0]" for example. Throws
  // std::logic_error unless engine/memories.vlt names it.
  virtual Cells cells(const std::string& instance, const char* variable) = 0;

  // A waveform of all signals and of `shown`, which has to stay in place, in the format FST. Throws
  // std::logic_error where the translation has no tracing, std::runtime_error where the file
  // cannot be written.
  virtual void open_waveform(const std::string& path, const ShownSignals& shown) = 0;
  // Writes what has changed; times have to grow.
  virtual void dump(std::int64_t time_ps) = 0;
  virtual void close_waveform() = 0;

  EnginePorts ports;
};

// What an engine has of z and P⁻¹. One with a preconditioner solves without it, too.
enum class Preconditioner { none, jacobi, blocks };

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
  int rows_in_parallel;
  int direction_banks;
  accel::DirectionMemory direction_memory;
  Preconditioner preconditioner;
  // All state begins with random values, which differ from seed to seed.
  std::unique_ptr<EngineModel> (*make)(int seed);

  bool preconditions() const { return preconditioner != Preconditioner::none; }

  static constexpr int kScalarBits = 64;
  static constexpr int kBlocksOfARow = 64;
  static constexpr int kPackagesOfARow = 255;
};

}  // namespace hvp::vp::rtl
