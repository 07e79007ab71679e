#include "models/tissue/step_watch.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "models/fem/assembly.h"
#include "models/index.h"
#include "models/tissue/noise.h"

namespace hvp::tissue {
namespace {

// Of a look besides the internal forces: 5 of each normalisation, 2 of the displaced body, 5 of K·x
// and Rayleigh's quotient, 4 of the recurrence, 2 of the noise.
constexpr Operations kLookAtComponent = {.add_multiply = 21, .divisions = 2};

}  // namespace

StepWatch::StepWatch(const PotentialBody& body, std::span<const double> mass)
    : body_(body), mass_(mass.begin(), mass.end()) {
  const fem::Body& of = body.body();
  assert(mass_.size() == at(of.active_nodes()));
  for (int a = 0; a < of.active_nodes(); ++a) {
    if (of.held(of.node_of_active()[at(a)])) mass_[at(a)] = 0;
  }
  double volume = 0;
  for (std::size_t e = 0; e < of.mesh().tetrahedra.size(); ++e) {
    volume += fem::element_geometry(of.mesh(), static_cast<int>(e)).volume();
  }
  length_ = std::cbrt(volume / static_cast<double>(of.mesh().tetrahedra.size()));
  for (std::vector<double>* state : {&x_, &before_, &moved_}) state->assign(3 * mass_.size(), 0.0);
  for (std::vector<double>* all : {&full_, &forces_}) all->assign(3 * of.mesh().nodes.size(), 0.0);
  add_noise(1);
  normalise();
}

// Of M-norm `size` in the mean.
void StepWatch::add_noise(double size) {
  double total = 0;
  for (const double m : mass_) total += m;
  const double scale = size / std::sqrt(total);  // the mean square of a number in [−1, 1) is ⅓
  for (std::size_t k = 0; k < x_.size(); ++k) {
    if (mass_[k / 3] > 0) x_[k] += scale * next_noise(noise_);
  }
}

// Divides both vectors by the norm of x.
double StepWatch::normalise() {
  double square = 0;
  for (std::size_t k = 0; k < x_.size(); ++k) square += mass_[k / 3] * x_[k] * x_[k];
  const double inverse = 1 / std::sqrt(square);
  for (double& x : x_) x *= inverse;
  for (double& x : before_) x *= inverse;
  return square;
}

void StepWatch::look(std::span<const double> u, std::span<const double> f,
                     std::span<const int> contact) {
  assert(u.size() == x_.size() && f.size() == forces_.size());
  const fem::Body& of = body_.body();
  for (const int node : contact) {
    for (std::size_t i = 0; i < 3; ++i) x_[3 * at(node) + i] = before_[3 * at(node) + i] = 0;
  }
  normalise();
  double largest = 0;
  for (const double x : x_) largest = std::max(largest, std::abs(x));
  const double share = kStrain * length_ / largest;
  for (std::size_t k = 0; k < x_.size(); ++k) moved_[k] = u[k] + share * x_[k];
  of.expand(moved_, full_);
  const Deformation found = body_.internal_forces(full_, forces_);
  operations_ = found.operations + operations_beside_forces();
  if (!found.defined()) return;

  // y = M⁻¹K·x in the place of moved_
  square_ = 0;
  for (std::size_t k = 0; k < x_.size(); ++k) {
    const std::size_t in_mesh = 3 * at(of.node_of_active()[k / 3]) + k % 3;
    const double product = (forces_[in_mesh] - f[in_mesh]) / share;
    square_ += mass_[k / 3] > 0 ? x_[k] * product : 0;
    moved_[k] = mass_[k / 3] > 0 ? product / mass_[k / 3] : 0;
  }
  // Chebyshev's recurrence for the interval from 0 to kBulk·ω².
  const double half = std::max(kBulk * square_, std::numeric_limits<double>::min()) / 2;
  for (std::size_t k = 0; k < x_.size(); ++k) {
    const double next = 2 / half * (moved_[k] - half * x_[k]) - before_[k];
    before_[k] = x_[k];
    x_[k] = next;
  }
  normalise();
  add_noise(kNoise);
}

Operations StepWatch::operations_beside_forces() const {
  return static_cast<double>(x_.size()) * kLookAtComponent;
}

double StepWatch::stable_step_s() const {
  return square_ > 0 ? 2 / std::sqrt(square_) : std::numeric_limits<double>::infinity();
}

}  // namespace hvp::tissue
