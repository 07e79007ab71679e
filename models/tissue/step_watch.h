#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "models/tissue/noise.h"
#include "models/tissue/potential_body.h"

namespace hvp::tissue {

// The present limit of an explicit run (stable_step.h), for one evaluation of the internal forces a
// look: an iteration for the largest eigenvalue of M⁻¹K that goes on from frame to frame. K·x is a
// difference of internal forces. Each look is a step of Chebyshev's recurrence, which keeps modes
// of less than kBulk times the present estimate from growing and lets the others grow; a little
// noise is added, so that a mode that was small is found when it becomes the largest one.
//
// The estimate is Rayleigh's quotient of the present tangent, so that its step is never below the
// true limit, but for the difference's error (10⁻⁵): a run whose substep is above it is unstable;
// one that is below it by a few per cent may be. How near and how soon: docs/tissue.md.
class StepWatch {
 public:
  // Chosen: with 0.9 it takes twice the looks until a mode is found that slowly passes another, and
  // with 1 or more noise the estimate is less exact.
  static constexpr double kBulk = 0.97;
  static constexpr double kNoise = 0.01;   // of the vector's norm
  static constexpr double kStrain = 1e-6;  // of the difference

  // Keeps a reference to the body, and not to the mass (CentralDifferences::mass()).
  StepWatch(const PotentialBody& body, std::span<const double> mass);

  // One step at the displacements `u` over active nodes, whose internal forces over mesh nodes are
  // `f`. The nodes in `contact` do not move; without them it is the limit after their release,
  // which is not above the other. Allocates nothing.
  void look(std::span<const double> u, std::span<const double> f,
            std::span<const int> contact = {});

  // s; infinite before the first look, and if no mode resists. It stays as it was where a look
  // found elements that are not defined beside `u`.
  double stable_step_s() const;
  // That of the last look.
  const Operations& operations() const { return operations_; }
  // Its part besides the internal forces, the same in every look.
  Operations operations_beside_forces() const;

 private:
  void add_noise(double size);
  double normalise();

  const PotentialBody& body_;
  std::vector<double> mass_;  // by active node; zero where the body holds it
  double length_;             // m, of a displacement of strain one
  double square_ = 0;         // the estimate of ω²
  std::vector<double> x_;     // over active nodes, xᵀMx = 1
  std::vector<double> before_;
  std::vector<double> moved_;   // u + a little of x
  std::vector<double> full_;    // the same over mesh nodes
  std::vector<double> forces_;  // there
  std::uint32_t noise_ = kFirstNoise;
  Operations operations_;
};

}  // namespace hvp::tissue
