// The matrix: its load, and the update of a node's row and column.
#include <algorithm>

#include <spdlog/spdlog.h>

#include "models/config/input_error.h"
#include "vp/fpga/accelerator.h"
#include "vp/fpga/board_settings.h"
#include "vp/fpga/packed_words.h"

namespace hvp::vp {

void Accelerator::load_done() {
  fixed::Settings settings;
  BoardError error = read_settings(bank_, settings);
  if (error.code == ErrorCode::none) error = read_matrix(bank_, matrix_);
  if (error.code != ErrorCode::none) {
    raise(error);
    return;
  }
  if (!supported(settings) || !load_engine(settings)) return;
  solver_.reset();
  loaded_method_ = settings.method;
  has_previous_u_ = false;
  b_.assign(static_cast<std::size_t>(matrix_.rows()), 0);
  u_.assign(static_cast<std::size_t>(matrix_.rows()), 0);
  give_engine_x();
  if (cycles_ != nullptr) {
    begin(Running::load, *commanding_tag_);
    cycles_->start_inversion();
  } else {
    run_for(Running::load, *commanding_tag_, loosely_timed_->load(settings.method));
  }
}

// How the matrix lies in the memories. Through the driver's frames nothing may be thrown.
bool Accelerator::load_engine(const fixed::Settings& settings) {
  try {
    if (phases_ != nullptr) phases_->load(matrix_, settings);
    if (cycles_ != nullptr) {
      cycles_->load(matrix_, settings);
    } else {
      loosely_timed_.emplace(architecture_, accel::pattern_of(matrix_.row_begin, matrix_.column));
    }
    return true;
  } catch (const InputError& e) {
    spdlog::warn("the board cannot hold the matrix: {}", e.what());
    raise({ErrorCode::internal_fault, 0});
    return false;
  }
}

void Accelerator::update_node() {
  if (bank_.get(field::kStatusMatrixLoaded) == 0) {
    raise({ErrorCode::not_loaded, 0});
    return;
  }
  const std::uint32_t node = bank_.get(field::kUpdateNodeNode);
  if (node >= static_cast<std::uint32_t>(matrix_.block_rows())) {
    raise({ErrorCode::bad_node, node});
    return;
  }
  const auto row = static_cast<int>(node);
  const std::span<const std::int32_t> present = matrix_.row(row);
  if (bank_.get(field::kUpdateKindKind) == static_cast<std::uint32_t>(UpdateKind::constrain)) {
    try {
      matrix_.set_contact(row, static_cast<std::int32_t>(bank_.get(field::kUpdateDiagonalValue)));
    } catch (const InputError&) {
      raise({ErrorCode::bad_setting, offset_of(Register::update_diagonal)});
      return;
    }
  } else {
    const std::size_t blocks = present.size() / 9;
    if (bank_.get(field::kUpdateBlocksCount) != blocks) {
      raise({ErrorCode::bad_row, static_cast<std::uint32_t>(blocks)});
      return;
    }
    row_.resize(present.size());
    const std::span<const std::uint32_t> staged = bank_.memory(Aperture::row);
    for (std::size_t i = 0; i < row_.size(); ++i) {
      row_[i] = packed_element(staged, i, static_cast<unsigned>(matrix_.bits), one_a_word());
    }
    matrix_.restore_row(row, row_);
  }
  if (solver_ != nullptr) solver_->update(row);
  write_back_node(matrix_, row, bank_);
  if (cycles_ != nullptr) {
    edit_engine(row);
    return;
  }

  const auto begin = static_cast<std::size_t>(matrix_.row_begin[node]);
  const auto end = static_cast<std::size_t>(matrix_.row_begin[node + 1]);
  // A matrix is loaded, so that METHOD is what it was loaded with.
  const std::int64_t clocks = loosely_timed_->node_update(
      row, std::span(matrix_.column).subspan(begin, end - begin), loaded_method_);
  hold_access(clocks);
}

// U is the engine's memory of x, which it brings into the copies of d when the host has written.
void Accelerator::give_engine_x() {
  if (u_.empty()) return;  // no matrix has been loaded
  if (phases_ != nullptr) phases_->written_x();
  if (cycles_ == nullptr) return;
  engine_u_.resize(u_.size());
  const unsigned vector_bits = bank_.get(field::kFormatVectorBits);
  const std::span<const std::uint32_t> words = bank_.memory(Aperture::u);
  for (std::size_t i = 0; i < engine_u_.size(); ++i) {
    engine_u_[i] = packed_element(words, i, vector_bits, one_a_word());
  }
  cycles_->write_x(engine_u_);
}

// The engine writes its packages while the access that gave the command is held.
void Accelerator::edit_engine(int node) {
  if (matrix_.is_contact[static_cast<std::size_t>(node)] != 0) {
    cycles_->start_constraining(node, matrix_.diagonal(3 * node));
  } else {
    cycles_->start_restoring(node, row_);
  }
  hold_access(cycles_->update_clocks());
}

void Accelerator::hold_access(std::int64_t clocks) {
  wait_states_ = level_ == Timing::untimed ? 0 : clocks * architecture_.clock_period_ps();
  ledger_.extend(*commanding_tag_, Part::fpga, Phase::node_update, now_ps(),
                 now_ps() + wait_states_);
}

}  // namespace hvp::vp
