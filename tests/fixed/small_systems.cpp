#include "tests/fixed/small_systems.h"

#include "models/fixed/reference_solver.h"

namespace hvp::fixed::test {

QuantisedMatrix dense_matrix(const std::vector<std::vector<std::int32_t>>& rows, int bits) {
  QuantisedMatrix m;
  m.bits = bits;
  m.scale = 1;
  const std::size_t nodes = rows.size() / 3;
  for (std::size_t i = 0; i < nodes; ++i) {
    for (std::size_t j = 0; j < nodes; ++j) {
      m.column.push_back(static_cast<int>(j));
      for (std::size_t e = 0; e < 9; ++e) m.value.push_back(rows[3 * i + e / 3][3 * j + e % 3]);
    }
    m.row_begin.push_back(static_cast<int>(m.column.size()));
  }
  m.is_contact.assign(nodes, 0);
  return m;
}

void Recorder::iteration(const IterationState& s) {
  history.push_back({.x = {s.x.begin(), s.x.end()},
                     .r = {s.r.begin(), s.r.end()},
                     .z = {s.z.begin(), s.z.end()},
                     .d = {s.d.begin(), s.d.end()},
                     .q = {s.q.begin(), s.q.end()},
                     .d_q = s.d_q,
                     .z_r = s.z_r,
                     .alpha = s.alpha,
                     .beta = s.beta,
                     .residual_exponent = s.residual_exponent,
                     .direction_exponent = s.direction_exponent});
}

Solution solve(const Settings& settings, const QuantisedMatrix& matrix,
               const std::vector<std::int32_t>& b, std::vector<std::int32_t> guess) {
  Solution result;
  result.x = std::move(guess);
  result.x.resize(b.size(), 0);
  Recorder recorder;
  ReferenceSolver solver(settings);
  result.report = solver.solve(matrix, {.b = b, .x = result.x}, &recorder);
  result.history = std::move(recorder.history);
  return result;
}

}  // namespace hvp::fixed::test
