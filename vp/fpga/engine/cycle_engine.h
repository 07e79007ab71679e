#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <systemc>
#include <vector>

#include "models/accel/architecture.h"
#include "models/fixed/quantised_matrix.h"
#include "models/fixed/reference_preconditioner.h"
#include "models/fixed/settings.h"
#include "models/fixed/solver.h"
#include "vp/fpga/engine/direction_copies.h"
#include "vp/fpga/engine/divider.h"
#include "vp/fpga/engine/engine_clock.h"
#include "vp/fpga/engine/flip.h"
#include "vp/fpga/engine/layout.h"
#include "vp/fpga/engine/matrix_editor.h"
#include "vp/fpga/engine/sequencer.h"
#include "vp/fpga/engine/spmxv_block.h"
#include "vp/fpga/engine/vector_unit.h"

namespace hvp::vp::engine {

// Throws InputError if an engine cannot have this architecture (with the key of
// accel::Architecture), or if a level has no such solver (key "method" or "start" of
// fixed::Settings).
void require_supported(const accel::Architecture& architecture);
void require_supported(const fixed::Settings& settings);

// The accelerator of thesis chapter 5 with every clock. The words come out of its pipelines and are
// those of fixed::ReferenceSolver; their clocks follow from ports, pipelines and the units that
// wait for each other. It supports the methods cg, jacobi-pcg and block-jacobi-pcg.
//
// The bus may access the memories while the engine is idle. In that time the engine copies x into
// the copies of d, for the first product of the next solve: after each solve, and when the host has
// written x. The value of d is not needed then.
class CycleEngine : public sc_core::sc_module {
 public:
  CycleEngine(const sc_core::sc_module_name& name, const accel::Architecture& architecture);

  // Fills the matrix memories and drops all vectors. Throws InputError as require_supported() and
  // Layout do.
  void load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings);
  void write_b(std::span<const std::int32_t> words);
  // The words have Settings::vector_bits. An extrapolated start has no solution before them.
  void write_x(std::span<const std::int32_t> words);
  void read_x(std::span<std::int32_t> words) const;
  // The words of the matrix memories in the pattern that was loaded.
  const fixed::QuantisedMatrix& read_matrix();

  // Each of these may be started only while idle; solves and inversions end with done(). Their
  // clocks are the edges from the start to the last one.
  void start_inversion();  // P⁻¹ of all nodes: the matrix was loaded
  void start_constraining(int node, std::int32_t diagonal);
  void start_restoring(int node, std::span<const std::int32_t> row);
  // The clocks for which the access that started one of these two is stalled.
  std::int64_t update_clocks() const { return editor_.edges(); }
  // Starts a solve, which first waits for x in the copies of d.
  void start_solve(const fixed::Settings& settings, fixed::Observer* observer = nullptr);
  void abort();
  // The next extrapolated start has no solution before x.
  void forget_previous() { has_previous_ = false; }

  // From now on bits of its memories and registers may flip, which costs wall time: its pipelines
  // carry the words that they have read. To be called while no solve runs.
  void carry_words();
  bool carries_words() const { return carries_words_; }
  // How many values an index of a flip has, of which those before it are chosen; 0: there is no
  // such word.
  int flip_range(const Flip& flip, int Flip::*index) const;
  // Flips a bit behind the last edge and before the next one. The flip is complete and within its
  // ranges; words have to be carried.
  void flip(const Flip& flip);

  const sc_core::sc_event& done() const { return done_; }
  // True if no work that the host asked for is under way.
  bool idle() const { return !solving_ && !editor_.busy(); }
  std::int64_t clocks() const;
  // When the last command was over.
  const sc_core::sc_time& ended() const { return ended_; }
  // The clocks of the last solve by state; the rest is its wait for x.
  const StateClocks& state_clocks() const { return sequencer_.state_clocks(); }
  // The number of solves started.
  std::int64_t jobs() const { return jobs_; }
  // The last solve's report as the hardware knows it: iterations, replacements, clamped and wrapped
  // words, breakdowns, and their flags. It has no norms.
  fixed::Report report();

  const accel::Architecture& architecture() const { return architecture_; }
  const Layout& layout() const { return *layout_; }
  const fixed::Settings& settings() const { return settings_; }
  const EngineClock& clock() const { return clock_; }
  const Sequencer& sequencer() const { return sequencer_; }
  const VectorUnit& vector_unit() const { return vectors_; }
  const Divider& divider() const { return divider_; }
  const MatrixEditor& matrix_editor() const { return editor_; }
  const SpmxvBlock& block(int partition) const {
    return *blocks_[static_cast<std::size_t>(partition)];
  }

 private:
  void clocked();
  void require_idle();
  void begin_command();
  void end_command();
  void start_editing(int node);
  void copy_x();
  void begin_solve();
  void end_solve();
  void end_editing();
  void end_copy();
  void close_clock_if_idle();
  void observe();
  void fetch_row(int row);
  void make_inverse(const fixed::Settings& settings);
  void refresh_inverse(int node);
  std::vector<std::int32_t>& flipped_vector(FlipPlace place);
  int word_bits(FlipPlace place) const;

  accel::Architecture architecture_;
  EngineClock clock_;
  DirectionCopies direction_;
  std::vector<std::unique_ptr<SpmxvBlock>> blocks_;
  VectorUnit vectors_;
  Divider divider_;
  Sequencer sequencer_;
  MatrixEditor editor_;
  sc_core::sc_event done_;

  std::optional<Layout> layout_;
  fixed::QuantisedMatrix matrix_;  // the pattern; read_matrix() fetches the words
  fixed::Settings settings_;
  fixed::Settings inverse_settings_;  // with which P⁻¹ was made
  std::optional<fixed::ReferencePreconditioner> preconditioner_;
  fixed::Observer* observer_ = nullptr;
  int edited_node_ = -1;  // −1: all
  bool solving_ = false;  // begun, or waiting for the copy
  bool has_previous_ = false;
  bool carries_words_ = false;
  std::int64_t jobs_ = 0;
  sc_core::sc_time commanded_;
  sc_core::sc_time ended_;
};

}  // namespace hvp::vp::engine
