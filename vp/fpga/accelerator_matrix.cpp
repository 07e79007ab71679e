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
  if (!supported(settings) || !load_memories(settings)) return;
  solver_.reset();
  loaded_method_ = settings.method;
  has_previous_u_ = false;
  b_.assign(static_cast<std::size_t>(matrix_.rows()), 0);
  u_.assign(static_cast<std::size_t>(matrix_.rows()), 0);
  give_x();
  begin(Running::load, *commanding_tag_);
  end_after(timing_->start_load(settings.method));
}

// Through the driver's frames nothing may be thrown.
bool Accelerator::load_memories(const fixed::Settings& settings) {
  try {
    timing_->load(matrix_, settings);
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
  if (!change_row(row)) return;
  if (solver_ != nullptr) solver_->update(row);
  write_back_node(matrix_, row, bank_);
  // A matrix is loaded, so that METHOD is what it was loaded with.
  hold_access(timing_->update_node(matrix_, row, loaded_method_, row_));
}

// The node's row and column, as the registers say; false for what the board refuses.
bool Accelerator::change_row(int node) {
  if (bank_.get(field::kUpdateKindKind) == static_cast<std::uint32_t>(UpdateKind::constrain)) {
    try {
      matrix_.set_contact(node, static_cast<std::int32_t>(bank_.get(field::kUpdateDiagonalValue)));
    } catch (const InputError&) {
      raise({ErrorCode::bad_setting, offset_of(Register::update_diagonal)});
      return false;
    }
    return true;
  }
  const std::span<const std::int32_t> present = matrix_.row(node);
  const std::size_t blocks = present.size() / 9;
  if (bank_.get(field::kUpdateBlocksCount) != blocks) {
    raise({ErrorCode::bad_row, static_cast<std::uint32_t>(blocks)});
    return false;
  }
  row_.resize(present.size());
  const std::span<const std::uint32_t> staged = bank_.memory(Aperture::row);
  for (std::size_t i = 0; i < row_.size(); ++i) {
    row_[i] = packed_element(staged, i, static_cast<unsigned>(matrix_.bits), one_a_word());
  }
  matrix_.restore_row(node, row_);
  return true;
}

// U is an engine's memory of x, which it brings into the copies of d when the host has written.
void Accelerator::give_x() {
  if (u_.empty()) return;  // no matrix has been loaded
  written_x_.resize(timing_->has_words() ? u_.size() : 0);
  const unsigned vector_bits = bank_.get(field::kFormatVectorBits);
  const std::span<const std::uint32_t> words = bank_.memory(Aperture::u);
  for (std::size_t i = 0; i < written_x_.size(); ++i) {
    written_x_[i] = packed_element(words, i, vector_bits, one_a_word());
  }
  timing_->write_x(written_x_);
}

void Accelerator::hold_access(std::int64_t clocks) {
  wait_states_ = clocks * clock_period_;
  ledger_.extend(*commanding_tag_, Part::fpga, Phase::node_update, now_ps(),
                 now_ps() + wait_states_);
}

}  // namespace hvp::vp
