#include "vp/fpga/engine/matrix_editor.h"

#include <algorithm>

#include "models/index.h"

namespace hvp::vp::engine {

namespace {

// Reciprocals that P⁻¹ of a node takes: a block is symmetric, so that six of nine are different.
int divisions_a_node(fixed::Method method) {
  if (method == fixed::Method::jacobi_pcg) return 3;
  return method == fixed::Method::block_jacobi_pcg ? 6 : 0;
}

}  // namespace

MatrixEditor::MatrixEditor(const sc_core::sc_module_name& name,
                           const accel::Architecture& architecture,
                           std::vector<std::unique_ptr<SpmxvBlock>>& blocks)
    : sc_module(name), architecture_(architecture), blocks_(blocks) {}

void MatrixEditor::load(const Layout& layout, const std::vector<std::uint8_t>& contact) {
  layout_ = &layout;
  contact_ = contact;
  staged_block_of_.assign(at(layout.nodes()), -1);
  busy_ = false;
}

void MatrixEditor::constrain(int node, std::int32_t diagonal, const fixed::Settings& settings) {
  restoring_ = false;
  diagonal_ = diagonal;
  contact_[at(node)] = 1;
  begin(node, settings);
}

void MatrixEditor::restore(int node, std::span<const std::int32_t> row,
                           const fixed::Settings& settings) {
  restoring_ = true;
  staged_.assign(row.begin(), row.end());
  contact_[at(node)] = 0;
  begin(node, settings);
}

void MatrixEditor::invert_all(const fixed::Settings& settings) {
  const std::int64_t divisions = std::int64_t{divisions_a_node(settings.method)} * layout_->nodes();
  visits_.clear();
  next_visit_ = 0;
  drain_ = divisions == 0 ? 1
                          : divisions * architecture_.inverse_division(settings) +
                                architecture_.phase_clocks();
  edges_ = drain_;
  busy_ = true;
}

// The node's own packages tell its neighbours; theirs follow.
void MatrixEditor::begin(int node, const fixed::Settings& settings) {
  node_ = node;
  visits_.clear();
  next_visit_ = 0;
  std::ranges::fill(staged_block_of_, -1);
  const auto list = [this](int row) {
    const RowPlace& place = layout_->place(row);
    for (int k = 0; k < place.packages; ++k) {
      visits_.push_back({row, place.first_package + k, k * layout_->package_columns() / 3});
    }
  };
  list(node);
  const RowPlace& own = layout_->place(node);
  const Partition& partition = layout_->partitions()[at(own.partition)];
  int previous = -1;
  int block = 0;
  for (int k = 0; k < own.packages; ++k) {
    const std::size_t package = at(own.first_package + k);
    for (int c = 0; c < partition.columns[package]; ++c) {
      const int index = (partition.phase[package] + c) / 3;
      const int neighbour = partition.node[package * at(layout_->nodes_in_package()) + at(index)];
      if (neighbour == previous) continue;
      previous = neighbour;
      staged_block_of_[at(neighbour)] = block++;
      if (neighbour != node) list(neighbour);
    }
  }
  drain_ = architecture_.phase_clocks() + std::int64_t{divisions_a_node(settings.method)} *
                                              architecture_.inverse_division(settings);
  if (settings.method == fixed::Method::block_jacobi_pcg) drain_ += architecture_.phase_clocks();
  edges_ = static_cast<std::int64_t>(visits_.size()) + drain_;
  busy_ = true;
}

void MatrixEditor::clocked() {
  if (!busy_) return;
  if (next_visit_ < visits_.size()) {
    visit(visits_[next_visit_++]);
    return;
  }
  if (--drain_ <= 0) finish();
}

void MatrixEditor::finish() {
  busy_ = false;
  if (finished) finished();
}

// The word for entry (row, column) of the visited row's block in column `block_column`.
std::int32_t MatrixEditor::word(const Visit& visit, int block_column, int row, int column) const {
  if (!restoring_) {
    const bool diagonal = visit.row == node_ && block_column == node_ && row == column;
    return diagonal ? diagonal_ : 0;
  }
  if (visit.row == node_) {
    const int block = staged_block_of_[at(block_column)];
    return staged_[at(9 * block + 3 * row + column)];
  }
  const int block = staged_block_of_[at(visit.row)];
  return staged_[at(9 * block + 3 * column + row)];
}

void MatrixEditor::visit(const Visit& visit) {
  const RowPlace& place = layout_->place(visit.row);
  const Partition& partition = layout_->partitions()[at(place.partition)];
  const auto package = at(visit.package);
  const std::span<std::int32_t> words = blocks_[at(place.partition)]->package_words(visit.package);
  const int width = layout_->package_columns();
  for (int c = 0; c < partition.columns[package]; ++c) {
    const int position = partition.phase[package] + c;
    const int column = partition.node[package * at(layout_->nodes_in_package()) + at(position / 3)];
    if (visit.row != node_ && column != node_) continue;
    const int other = visit.row == node_ ? column : visit.row;
    if (restoring_ && other != node_ && is_contact(other)) continue;
    for (int r = 0; r < 3; ++r) words[at(r * width + c)] = word(visit, column, r, position % 3);
  }
}

}  // namespace hvp::vp::engine
