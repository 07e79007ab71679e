#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "models/accel/architecture.h"
#include "models/fixed/quantised_matrix.h"
#include "models/fixed/settings.h"
#include "models/fixed/solver.h"
#include "vp/fpga/engine/flip.h"
#include "vp/fpga/engine/layout.h"
#include "vp/fpga/engine/sequencer.h"
#include "vp/fpga/engine_port_sink.h"
#include "vp/fpga/rtl/engine_memories.h"
#include "vp/fpga/rtl/engine_model.h"

namespace hvp::vp::rtl {

// The size that engine.sv has been translated in for scenarios.
extern const EngineSize kEngineThesis;

// Throws InputError if engine.sv of this size is not the engine of such an architecture, or does
// not solve by such settings; with the key of accel::Architecture or fixed::Settings.
void require_fitting(const EngineSize& size, const accel::Architecture& architecture);
void require_fitting(const EngineSize& size, const fixed::Settings& settings);

// The engine in SystemVerilog with its host: it fills the memories through the host's port and
// gives orders. It has clocks of its own and no simulated time: each member runs as many as it
// takes.
class RtlEngine {
 public:
  // Throws InputError as require_fitting() does.
  RtlEngine(const EngineSize& size, const accel::Architecture& architecture, int seed = 1);

  // Throws InputError as require_fitting() and engine::Layout do, or with the key "nodes" or
  // "partitions" if the memories are too small.
  void load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings);
  void write_b(std::span<const std::int32_t> words);
  // Also orders a copy of x into the copies of d.
  void write_x(std::span<const std::int32_t> words);
  void read_x(std::span<std::int32_t> words);
  void forget_previous();

  // Orders a solve; the members below give it clocks.
  void start_solve(const fixed::Settings& settings);
  // Runs until the words of the next iteration are written; false if the solve is over, or has had
  // so many clocks, before.
  bool run_iteration(std::int64_t most);
  // Runs until the solve has had so many clocks, or is over.
  void run_until(std::int64_t clocks);
  // Orders a copy of x into the copies of d, as the engine does when a solve is over. Every other
  // order and read but a run of its clocks ends it first.
  void start_copy();
  // Runs it until it has had so many clocks, or is over.
  void run_copy_until(std::int64_t clocks);
  void end_copy();
  // From now on bits may flip: what nothing else reads before it is written begins as in the
  // cycle-accurate engine.
  void expect_flips();
  // Flips a bit of a memory or register.
  void flip(const engine::Flip& flip);
  void abort();
  // Makes P⁻¹ of all nodes, which a load leaves to this. Without a preconditioner it takes a clock.
  // An edit and a solve do so first where nobody has. Returns the clocks that it takes, or `most`
  // where it has had as many and is not over.
  std::int64_t invert(std::int64_t most = kNoLimit);
  // Clears the row and the column of a node but for `diagonal`, or restores them from a row as
  // engine::CycleEngine does. Returns the clocks that it takes.
  std::int64_t constrain(int node, std::int32_t diagonal);
  std::int64_t restore(int node, std::span<const std::int32_t> row);

  // Called behind each edge of a solve, of a copy of x and of a change of the matrix; empty:
  // nobody.
  void watch(std::function<void()> edge) { watcher_ = std::move(edge); }
  EngineModel& model() { return *model_; }

  bool idle() const { return ports_.state == 0; }
  bool copying() const { return copying_; }
  std::int64_t clocks() const { return clocks_; }  // of the last solve, without a wait for x
  // Of the last copy, once it is over.
  std::int64_t copy_clocks() const { return copy_clocks_; }
  const engine::StateClocks& state_clocks() const { return state_clocks_; }
  // What the hardware knows of the last solve.
  fixed::Report report() const;
  EnginePortSink record;

  const EnginePorts& ports() const { return ports_; }
  const EngineMemories& memories() const { return memories_; }
  EngineMemories& memories() { return memories_; }
  const EngineSize& size() const { return size_; }
  const fixed::Settings& settings() const { return settings_; }

 private:
  static constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max();

  void write(Space space, std::uint32_t address, std::int64_t word);
  void set(std::uint32_t number, std::int64_t word) { write(Space::settings, number, word); }
  void write_vector(Space space, std::span<const std::int32_t> words);
  void write_package(const engine::Partition& partition, int number, int package,
                     std::span<const std::int32_t> words);
  void write_places(const engine::Layout& layout, const fixed::QuantisedMatrix& matrix);
  std::int64_t edit(int node, bool restores, std::int32_t diagonal);
  void require_inverse(const fixed::Settings& settings);
  std::int64_t run_order(std::int64_t most = kNoLimit);
  void set_all(const fixed::Settings& settings);
  void reset();
  void solve_clock();
  void record_solve();
  void tell(char what, std::int64_t first, std::int64_t second = 0, std::int64_t third = 0) const;
  void tick();
  void flip_index(int partition, int package, int bit);
  void clear_unused();
  void clear_q();
  // Nodes that a package touches.
  int nodes_in_package() const {
    return size_.package % 3 == 0 ? size_.package / 3 : (size_.package + 1) / 3 + 1;
  }

  const EngineSize& size_;
  accel::Architecture architecture_;
  std::unique_ptr<EngineModel> model_;
  EnginePorts& ports_;
  EngineMemories memories_;
  fixed::Settings settings_;
  std::function<void()> watcher_;
  int nodes_ = 0;
  std::vector<int> packages_;  // of the partitions
  bool has_inverse_ = false;   // P⁻¹ of the loaded matrix
  std::int64_t clocks_ = 0;
  std::int64_t copy_clocks_ = 0;
  bool copying_ = false;
  bool expects_flips_ = false;
  bool has_solved_ = false;  // since the matrix was loaded
  engine::StateClocks state_clocks_{};
};

}  // namespace hvp::vp::rtl
