#include "vp/fpga/timing/closed_form.h"

#include <cstddef>

namespace hvp::vp {

void ClosedForm::load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& /*settings*/) {
  clocks_.emplace(architecture_, accel::pattern_of(matrix.row_begin, matrix.column));
}

std::optional<std::int64_t> ClosedForm::start_load(fixed::Method method) {
  return clocks_->load(method);
}

std::optional<std::int64_t> ClosedForm::start_solve(const fixed::Settings& settings,
                                                    const fixed::Report& report) {
  return clocks_->solve(accel::solve_made(settings, report)).total();
}

std::int64_t ClosedForm::update_node(const fixed::QuantisedMatrix& matrix, int node,
                                     fixed::Method method, std::span<const std::int32_t> /*row*/) {
  const auto row = static_cast<std::size_t>(node);
  const auto begin = static_cast<std::size_t>(matrix.row_begin[row]);
  const auto end = static_cast<std::size_t>(matrix.row_begin[row + 1]);
  return clocks_->node_update(node, std::span(matrix.column).subspan(begin, end - begin), method);
}

}  // namespace hvp::vp
