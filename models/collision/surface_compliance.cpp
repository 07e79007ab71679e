#include "models/collision/surface_compliance.h"

#include <algorithm>

#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::collision {

namespace {

std::size_t pairs(std::size_t nodes) { return nodes * (nodes + 1) / 2; }

}  // namespace

SurfaceCompliance::SurfaceCompliance(const fem::Body& body, const sparse::BlockMatrix& a,
                                     std::span<const int> surface_nodes, std::size_t largest_table)
    : solver_(std::make_shared<const fem::DirectSolver>(a)),
      slot_(body.mesh().nodes.size(), -1),
      x_(at(a.rows())) {
  if (!solver_->positive_definite()) {
    throw InputError("kind",
                     "the body's matrix is not positive definite: expected \"node\", which "
                     "needs no compliance");
  }
  for (const int node : surface_nodes) {
    if (body.active_index(node) < 0 || body.held(node)) continue;
    slot_[at(node)] = static_cast<int>(active_.size());
    active_.push_back(body.active_index(node));
  }
  const std::size_t nodes = active_.size();
  if (9 * sizeof(double) * pairs(nodes) > largest_table) {
    columns_.assign(std::min(kKept, nodes), Column{-1, 0, std::vector<double>(9 * nodes)});
    return;
  }
  auto table = std::make_shared<std::vector<double>>(9 * pairs(nodes));
  std::vector<double> column(9 * nodes);
  for (std::size_t j = 0; j < nodes; ++j) {
    solve_for(static_cast<int>(j), column);
    for (std::size_t i = j; i < nodes; ++i) {
      double* block = &(*table)[9 * (pairs(i) + j)];
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t r = 0; r < 3; ++r) block[3 * r + c] = column[3 * (nodes * c + i) + r];
      }
    }
    // A block of the diagonal is symmetric but for rounding.
    double* own = &(*table)[9 * (pairs(j) + j)];
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < r; ++c) {
        own[3 * r + c] = own[3 * c + r] = 0.5 * (own[3 * r + c] + own[3 * c + r]);
      }
    }
  }
  table_ = std::move(table);
}

void SurfaceCompliance::solve_for(int slot, std::span<double> column) {
  const std::size_t nodes = active_.size();
  for (std::size_t c = 0; c < 3; ++c) {
    std::ranges::fill(x_, 0.0);
    x_[3 * at(active_[at(slot)]) + c] = 1;
    solver_->solve(x_, x_);
    ++solves_;
    for (std::size_t i = 0; i < nodes; ++i) {
      std::copy_n(&x_[3 * at(active_[i])], 3, &column[3 * (nodes * c + i)]);
    }
  }
}

// The column that was not asked for the longest makes room.
const SurfaceCompliance::Column& SurfaceCompliance::column_of(int slot) {
  auto column = std::ranges::find(columns_, slot, &Column::slot);
  if (column == columns_.end()) {
    column = std::ranges::min_element(columns_, {}, &Column::asked);
    column->slot = slot;
    solve_for(slot, column->value);
  }
  column->asked = ++asked_;
  return *column;
}

Eigen::Matrix3d SurfaceCompliance::block(int node, int other) {
  const int i = slot_[at(node)];
  const int j = slot_[at(other)];
  Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
  if (i < 0 || j < 0) return block;
  if (tabulated()) {
    const double* entry = &(*table_)[9 * (pairs(at(std::max(i, j))) + at(std::min(i, j)))];
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) block(r, c) = i >= j ? entry[3 * r + c] : entry[3 * c + r];
    }
    return block;
  }
  const Column& column = column_of(j);
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) {
      block(r, c) = column.value[3 * (active_.size() * at(c) + at(i)) + at(r)];
    }
  }
  return block;
}

std::size_t SurfaceCompliance::bytes() const {
  if (tabulated()) return table_->size() * sizeof(double);
  std::size_t bytes = 0;
  for (const Column& column : columns_) bytes += column.value.size() * sizeof(double);
  return bytes;
}

// L and its transpose, an addition and a multiplication an entry each; D between them.
double SurfaceCompliance::solve_operations() const {
  return 4.0 * static_cast<double>(solver_->factor_nonzeros()) + solver_->rows();
}

}  // namespace hvp::collision
