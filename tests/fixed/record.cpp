#include "tests/fixed/record.h"

#include <algorithm>
#include <bit>

namespace hvp::fixed::test {

namespace {

std::string vector_difference(const std::vector<std::int32_t>& one,
                              const std::vector<std::int32_t>& other) {
  if (one.size() != other.size()) return "its length";
  const auto [a, b] = std::ranges::mismatch(one, other);
  if (a == one.end()) return "";
  return "word " + std::to_string(a - one.begin()) + ": " + std::to_string(*a) + " and " +
         std::to_string(*b);
}

std::string iteration_difference(const IterationRecord& one, const IterationRecord& other) {
  if (one.iteration != other.iteration) return "its number";
  if (!(one.alpha == other.alpha)) return "alpha";
  if (one.d_q != other.d_q) return "d_q";
  for (std::size_t v = 0; v < kVectorNames.size(); ++v) {
    const std::string found = vector_difference(one.vectors[v], other.vectors[v]);
    if (!found.empty()) return kVectorNames[v] + (" " + found);
  }
  if (one.z_r != other.z_r) return "z_r";
  if (!(one.beta == other.beta)) return "beta";
  if (one.residual_exponent != other.residual_exponent) return "residual_exponent";
  if (one.direction_exponent != other.direction_exponent) return "direction_exponent";
  return "";
}

// NaN or not: the same bits.
bool same(double one, double other) {
  return std::bit_cast<std::uint64_t>(one) == std::bit_cast<std::uint64_t>(other);
}

std::string report_difference(const Report& one, const Report& other) {
  if (one.iterations != other.iterations) return "iterations";
  if (one.reached != other.reached) return "reached";
  if (one.replacements != other.replacements) return "replacements";
  if (one.saturations != other.saturations) {
    return "saturations " + std::to_string(one.saturations) + " and " +
           std::to_string(other.saturations);
  }
  if (one.wraps != other.wraps) {
    return "wraps " + std::to_string(one.wraps) + " and " + std::to_string(other.wraps);
  }
  if (one.breakdowns != other.breakdowns) return "breakdowns";
  if (!(one.flags == other.flags)) return "flags";
  if (!same(one.rhs_norm, other.rhs_norm)) return "rhs_norm";
  if (!same(one.start_residual_norm, other.start_residual_norm)) return "start_residual_norm";
  if (!same(one.residual_norm, other.residual_norm)) return "residual_norm";
  if (!same(one.true_residual_norm, other.true_residual_norm)) return "true_residual_norm";
  if (!same(one.rounding_floor, other.rounding_floor)) return "rounding_floor";
  return "";
}

}  // namespace

void Record::iteration(const IterationState& s) {
  IterationRecord next{.iteration = s.iteration,
                       .vectors = {},
                       .d_q = s.d_q,
                       .z_r = s.z_r,
                       .alpha = s.alpha,
                       .beta = s.beta,
                       .residual_exponent = s.residual_exponent,
                       .direction_exponent = s.direction_exponent};
  for (const auto& vector : {s.x, s.r, s.z, s.d, s.q, s.w, s.n, s.v}) {
    next.vectors.emplace_back(vector.begin(), vector.end());
  }
  iterations.push_back(std::move(next));
}

Record record(Solver& solver, const std::vector<std::int32_t>& b, std::vector<std::int32_t> guess) {
  Record result;
  result.x = std::move(guess);
  result.report = solver.solve({.b = b, .x = result.x}, &result);
  return result;
}

std::string difference(const Record& one, const Record& other) {
  const std::size_t both = std::min(one.iterations.size(), other.iterations.size());
  for (std::size_t i = 0; i < both; ++i) {
    const std::string found = iteration_difference(one.iterations[i], other.iterations[i]);
    if (!found.empty()) return "iteration " + std::to_string(i + 1) + ", " + found;
  }
  if (one.iterations.size() != other.iterations.size()) {
    return "iterations observed: " + std::to_string(one.iterations.size()) + " and " +
           std::to_string(other.iterations.size());
  }
  const std::string found = vector_difference(one.x, other.x);
  if (!found.empty()) return "solution " + found;
  const std::string report = report_difference(one.report, other.report);
  return report.empty() ? "" : "report: " + report;
}

}  // namespace hvp::fixed::test
