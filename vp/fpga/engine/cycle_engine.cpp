#include "vp/fpga/engine/cycle_engine.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::vp::engine {

void require_supported(const accel::Architecture& architecture) {
  if (architecture.vector_clocks() >= 1) return;
  throw InputError("pipeline_clocks",
                   std::to_string(architecture.pipeline_clocks) +
                       " clocks leave the vector unit none beside memory_read_clocks, "
                       "multiplier_clocks and adder_tree_clocks, which are " +
                       std::to_string(architecture.phase_clocks() - architecture.vector_clocks()));
}

void require_supported(const fixed::Settings& settings) {
  using fixed::Method;
  if (settings.method == Method::chronopoulos_gear || settings.method == Method::pipelined_cg) {
    throw InputError("method",
                     "chronopoulos-gear and pipelined-cg are there at the levels untimed and "
                     "loosely-timed; cg, jacobi-pcg or block-jacobi-pcg was expected");
  }
}

CycleEngine::CycleEngine(const sc_core::sc_module_name& name,
                         const accel::Architecture& architecture)
    : sc_module(name),
      architecture_((require_supported(architecture), architecture)),
      clock_("clock", architecture.clock_period_ps(), [this] { clocked(); }),
      blocks_([this] {
        std::vector<std::unique_ptr<SpmxvBlock>> blocks;
        for (int i = 0; i < architecture_.partitions; ++i) {
          const std::string block = "spmxv_" + std::to_string(i);
          blocks.push_back(std::make_unique<SpmxvBlock>(block.c_str(), architecture_, direction_));
        }
        return blocks;
      }()),
      vectors_("vector_unit", architecture_, blocks_),
      divider_("divider"),
      sequencer_("sequencer", clock_),
      editor_("matrix_editor", architecture_, blocks_),
      done_("done") {
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    blocks_[i]->start = &sequencer_.product_start;
    blocks_[i]->taken = vectors_.taken[i].get();
    blocks_[i]->direction_write = &vectors_.direction_write;
  }
  vectors_.command = &sequencer_.vector_command;
  divider_.command = &sequencer_.division_command;
  sequencer_.vector_status = &vectors_.status;
  sequencer_.quotient = &divider_.quotient;
  sequencer_.iteration_made = [this] { observe(); };
  sequencer_.finished = [this] { end_solve(); };
  sequencer_.copied = [this] { end_copy(); };
  editor_.finished = [this] { end_editing(); };
}

// What one unit writes at an edge the others read from the next one on, so that their order does
// not matter.
void CycleEngine::clocked() {
  editor_.clocked();
  sequencer_.clocked();
  divider_.clocked();
  vectors_.clocked();
  direction_.clocked(vectors_.direction_write.read());
  // A product begins and ends with the vector unit's pass, but where an index word has flipped.
  if (vectors_.pass() != Pass::product && !carries_words_) return;
  for (const auto& block : blocks_) {
    block->address(vectors_.multiplies() ? -1 : vectors_.addressed());
    block->clocked();
    if (vectors_.product_ended()) block->reset();
  }
}

void CycleEngine::load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) {
  require_supported(settings);
  abort();
  layout_.emplace(architecture_, matrix.row_begin, matrix.column);
  direction_.load(layout_->nodes());
  matrix_ = matrix;
  settings_ = settings;
  for (int i = 0; i < architecture_.partitions; ++i) blocks_[at(i)]->load(*layout_, i);
  const int width = architecture_.package;
  for (int row = 0; row < matrix.block_rows(); ++row) {
    const RowPlace& place = layout_->place(row);
    SpmxvBlock& block = *blocks_[at(place.partition)];
    const std::span<const std::int32_t> words = matrix.row(row);
    for (int c = 0; c < static_cast<int>(words.size()) / 3; ++c) {
      const std::span<std::int32_t> package = block.package_words(place.first_package + c / width);
      for (int r = 0; r < 3; ++r) {
        package[at(r * width + c % width)] = words[at(9 * (c / 3) + 3 * r + c % 3)];
      }
    }
  }
  vectors_.load(matrix.block_rows());
  editor_.load(*layout_, matrix.is_contact);
  make_inverse(settings);
}

void CycleEngine::make_inverse(const fixed::Settings& settings) {
  inverse_settings_ = settings;
  preconditioner_.emplace(settings);
  preconditioner_->load(read_matrix());
  std::ranges::copy(preconditioner_->words(), vectors_.memories().inverse.begin());
}

void CycleEngine::write_b(std::span<const std::int32_t> words) {
  std::ranges::copy(words, vectors_.memories().b.begin());
}

void CycleEngine::write_x(std::span<const std::int32_t> words) {
  require_idle();
  std::ranges::copy(words, vectors_.memories().x.begin());
  has_previous_ = false;
  copy_x();
}

void CycleEngine::read_x(std::span<std::int32_t> words) const {
  std::ranges::copy(vectors_.memories().x, words.begin());
}

void CycleEngine::fetch_row(int row) {
  const int width = architecture_.package;
  const RowPlace& place = layout_->place(row);
  const SpmxvBlock& block = *blocks_[at(place.partition)];
  const int first = matrix_.row_begin[at(row)];
  const int columns = 3 * (matrix_.row_begin[at(row) + 1] - first);
  for (int c = 0; c < columns; ++c) {
    const std::span<const std::int32_t> package =
        block.package_words(place.first_package + c / width);
    for (int r = 0; r < 3; ++r) {
      matrix_.value[at(9 * (first + c / 3) + 3 * r + c % 3)] = package[at(r * width + c % width)];
    }
  }
}

const fixed::QuantisedMatrix& CycleEngine::read_matrix() {
  for (int row = 0; row < matrix_.block_rows(); ++row) {
    fetch_row(row);
    matrix_.is_contact[at(row)] = editor_.is_contact(row) ? 1 : 0;
  }
  return matrix_;
}

// Also counts where the clock is not open yet, or runs for a copy of x.
std::int64_t CycleEngine::clocks() const {
  const sc_core::sc_time end = idle() ? ended_ : sc_core::sc_time_stamp();
  const auto period = static_cast<std::uint64_t>(architecture_.clock_period_ps());
  return static_cast<std::int64_t>(((end - commanded_).value() + period - 1) / period);
}

// The host can come at the instant of an update's last edge, and before it.
void CycleEngine::require_idle() {
  if (editor_.busy() && editor_.at_last_edge()) editor_.finish();
  if (!idle()) throw std::logic_error("the engine is busy");
}

void CycleEngine::begin_command() {
  require_idle();
  commanded_ = sc_core::sc_time_stamp();
}

void CycleEngine::end_command() {
  ended_ = sc_core::sc_time_stamp();
  close_clock_if_idle();
}

void CycleEngine::close_clock_if_idle() {
  if (idle() && sequencer_.state() == State::idle) clock_.close();
}

// The editor's memories are not those of a copy, which goes on beside it.
void CycleEngine::start_editing(int node) {
  begin_command();
  edited_node_ = node;
  if (!clock_.is_open()) clock_.open();
}

void CycleEngine::start_inversion() {
  start_editing(-1);
  editor_.invert_all(inverse_settings_);
}

void CycleEngine::start_constraining(int node, std::int32_t diagonal) {
  start_editing(node);
  editor_.constrain(node, diagonal, inverse_settings_);
}

void CycleEngine::start_restoring(int node, std::span<const std::int32_t> row) {
  start_editing(node);
  editor_.restore(node, row, inverse_settings_);
}

void CycleEngine::end_editing() {
  if (edited_node_ >= 0) {
    refresh_inverse(edited_node_);
  } else {
    done_.notify(sc_core::SC_ZERO_TIME);
  }
  end_command();
}

void CycleEngine::copy_x() {
  clock_.open();
  sequencer_.copy();
}

void CycleEngine::end_copy() {
  if (solving_) {
    begin_solve();
  } else {
    close_clock_if_idle();
  }
}

void CycleEngine::start_solve(const fixed::Settings& settings, fixed::Observer* observer) {
  require_supported(settings);
  begin_command();
  observer_ = observer;
  if (settings.method != settings_.method) make_inverse(settings);
  settings_ = settings;
  ++jobs_;
  solving_ = true;
  if (sequencer_.state() != State::copy) begin_solve();
}

void CycleEngine::begin_solve() {
  vectors_.configure(settings_, preconditioner_->shift());
  divider_.configure(settings_, static_cast<int>(architecture_.division(settings_)));
  vectors_.report() = {};
  divider_.report() = {};
  clock_.open();
  sequencer_.start(settings_, preconditioner_->shift(), has_previous_);
  has_previous_ = settings_.start == fixed::Start::extrapolated;
}

void CycleEngine::end_solve() {
  solving_ = false;
  end_command();
  done_.notify(sc_core::SC_ZERO_TIME);
  copy_x();
}

void CycleEngine::abort() {
  solving_ = false;
  has_previous_ = false;
  clock_.close();
  sequencer_.abort();
  editor_.abort();
  divider_.reset();
  vectors_.reset();
  // The words on their way into the copies arrive, as nothing stops them there; the next matrix has
  // its own.
  direction_.clocked(vectors_.direction_write.next());
  direction_.clocked(vectors_.direction_write.next());
  for (const auto& block : blocks_) block->reset();
}

// The node's part of P⁻¹, from the words that now stand in the matrix memories.
void CycleEngine::refresh_inverse(int node) {
  fetch_row(node);
  preconditioner_->update(matrix_, node);
  const auto first = preconditioner_->words().begin() + 9 * node;
  std::copy_n(first, 9, vectors_.memories().inverse.begin() + 9 * node);
}

fixed::Report CycleEngine::report() {
  fixed::Report report = sequencer_.report();
  for (const fixed::Report* part : {&vectors_.report(), &divider_.report()}) {
    report.saturations += part->saturations;
    report.wraps += part->wraps;
    report.flags.merge(part->flags);
  }
  report.flags.merge(preconditioner_->flags());
  if (report.saturations > 0) report.flags.raise(stability::Flag::saturation);
  if (report.wraps > 0) report.flags.raise(stability::Flag::wrapped);
  return report;
}

void CycleEngine::observe() {
  if (observer_ == nullptr) return;
  const VectorMemories& memories = vectors_.memories();
  const Scalars& s = sequencer_.scalars();
  observer_->iteration({.iteration = sequencer_.report().iterations,
                        .x = memories.x,
                        .r = memories.r,
                        .z = settings_.preconditioned() ? memories.z : memories.r,
                        .d = blocks_.front()->direction(),
                        .q = memories.q,
                        .d_q = s.d_q.word,
                        .z_r = s.z_r.word,
                        .alpha = s.shown_alpha,
                        .beta = s.beta,
                        .residual_exponent = s.r_exponent + settings_.rhs_shift(),
                        .direction_exponent = s.d_exponent - s.z_exponent});
}

}  // namespace hvp::vp::engine
