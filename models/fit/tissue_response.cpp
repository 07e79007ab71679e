#include "models/fit/tissue_response.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "models/fit/tissue_factors.h"
#include "models/index.h"

namespace hvp::fit {
namespace {

// wᵀ·K_λ·w and wᵀ·K_μ·w over all nodes, the contact's displacement being one.
LamePair quadratic_form(const TissueSystem& system, const std::vector<FieldRow<1>>& w) {
  LamePair sum = system.contact_stiffness;
  for (const TissueSystem::Coupling& to : system.coupling) {
    const double twice = 2 * w[at(to.row)][0];
    sum.lambda += twice * to.stiffness.lambda;
    sum.mu += twice * to.stiffness.mu;
  }
  for (std::size_t i = 0; i < w.size(); ++i) {
    LamePair row;
    for (std::size_t k = at(system.row_begin[i]); k < at(system.row_begin[i + 1]); ++k) {
      const double x = w[at(system.column[k])][0];
      row.lambda += system.stiffness[k].lambda * x;
      row.mu += system.stiffness[k].mu * x;
    }
    sum.lambda += w[i][0] * row.lambda;
    sum.mu += w[i][0] * row.mu;
  }
  return sum;
}

std::vector<double> scaled(const std::vector<double>& x, double factor) {
  std::vector<double> result(x);
  for (double& value : result) value *= factor;
  return result;
}

}  // namespace

ContactMotion contact_motion(const TissueBody& body, std::span<const double> displacement) {
  ContactMotion motion;
  motion.displacement.assign(displacement.begin(), displacement.end());
  if (!body.dynamics) return motion;
  const double h = body.period_s;
  const double beta = body.dynamics->newmark_beta;
  const double gamma = body.dynamics->newmark_gamma;
  double u = 0;
  double v = 0;
  double a = 0;
  for (const double next : displacement) {
    if (body.velocity_of_way) {
      v = (next - u) / h;
      a = 0;
    } else {
      const double a_next = 2 / (beta * h * h) * (next - u - h * v) - (1 - beta) / beta * a;
      v += h * ((1 - gamma) * a + gamma * a_next);
      a = a_next;
    }
    u = next;
    motion.velocity.push_back(v);
    motion.acceleration.push_back(a);
  }
  return motion;
}

std::optional<TissueForce> static_force(const TissueSystem& system, const TissueValues& values,
                                        const ContactMotion& motion, bool derivatives) {
  const Lame material = lame(values.young_modulus, values.poisson_ratio);
  const TissueFactors factors(system, material.value, 0);
  if (!factors.positive_definite()) return std::nullopt;
  std::vector<FieldRow<1>> w(at(system.unknowns()), FieldRow<1>{});
  for (const TissueSystem::Coupling& to : system.coupling) {
    w[at(to.row)][0] = -combine(material.value, to.stiffness);
  }
  factors.solve(w);
  // The form is stationary at w, so k is exact to the square of the solve's rounding.
  const LamePair form = quadratic_form(system, w);
  TissueForce result;
  result.force = scaled(motion.displacement, combine(material.value, form));
  if (derivatives) {
    result.by_young_modulus = scaled(motion.displacement, combine(material.by_young_modulus, form));
    result.by_poisson_ratio = scaled(motion.displacement, combine(material.by_poisson_ratio, form));
  }
  return result;
}

double lowest_frequency(const TissueSystem& system, double young_modulus, double poisson_ratio) {
  if (std::ranges::all_of(system.mass, [](double kg) { return kg == 0; })) return 0;
  const TissueFactors factors(system, lame(young_modulus, poisson_ratio).value, 0);
  if (!factors.positive_definite()) return 0;
  constexpr int kMostIterations = 200;
  std::vector<FieldRow<1>> x(at(system.unknowns()));
  for (std::size_t i = 0; i < x.size(); ++i) x[i][0] = 1 + 0.5 * std::sin(static_cast<double>(i));
  double eigenvalue = 0;
  std::vector<FieldRow<1>> weighted(x.size());
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      double sum = 0;
      for (std::size_t k = at(system.row_begin[i]); k < at(system.row_begin[i + 1]); ++k) {
        sum += system.mass[k] * x[at(system.column[k])][0];
      }
      weighted[i][0] = sum;
    }
    double before = 0;
    for (std::size_t i = 0; i < x.size(); ++i) before += x[i][0] * weighted[i][0];
    std::vector<FieldRow<1>> next = weighted;
    factors.solve(next);
    // xᵀMx / xᵀM·K⁻¹Mx tends to ω² from above.
    double after = 0;
    for (std::size_t i = 0; i < x.size(); ++i) after += next[i][0] * weighted[i][0];
    const double estimate = before / after;
    const double scale = estimate;
    for (std::size_t i = 0; i < x.size(); ++i) x[i][0] = scale * next[i][0];
    const bool settled = std::abs(estimate - eigenvalue) < 1e-3 * estimate;
    eigenvalue = estimate;
    if (settled) break;
  }
  return std::sqrt(eigenvalue);
}

}  // namespace hvp::fit
