#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <ceres/cost_function.h>

#include "models/fit/problem.h"

namespace hvp::fit {

// The log of a hand, evenly sampled: the force on it, its position, and its intended position where
// that is known.
struct HandLog {
  double period = 0;             // s
  std::vector<double> force;     // N, on the hand; linear between samples
  std::vector<double> position;  // m
  std::vector<double> intended;  // m, linear between samples; empty: unknown and slow
};

// The Legendre polynomials of degree 0 to `degree` at s in [−1, 1].
std::vector<double> legendre(std::size_t degree, double s);

// The residuals (m) of the samples [first, last): the measured position minus that of a hand with
// the mass, stiffness and damping that are the parameters, and with the initial position, initial
// velocity and intended motion that explain the samples best. The intended motion is the log's, or
// else any polynomial up to `degree`. All these are linear unknowns. They are eliminated here
// (variable projection, Golub & Pereyra 1973) together with their derivatives, so that there are no
// own unknowns. `log` must outlive the cost function.
std::unique_ptr<ceres::CostFunction> hand_cost(const HandLog& log, std::size_t degree,
                                               std::size_t first, std::size_t last);

struct HandOptions {
  double window = 0.5;   // s, the length of a stretch
  double bandwidth = 2;  // Hz, of an intended motion that is not in the log
};

// A hand with mass m on a spring and a damper, whose other end follows the intended motion u:
//
//   m·x″ = F − b·(x′ − u′) − k·(x − u)
//
// F is the force on the hand. The parameters are, in this order: mass (kg), stiffness (N/m),
// damping (N·s/m). The residuals are positions, over windows that each begin with a position and a
// velocity of their own. Where u is not in the log it is a polynomial of its own in each window
// (hand_cost()).
class HandProblem final : public Problem {
 public:
  // Throws InputError as check_columns() does, and where position and force are not those of a mass
  // on a spring.
  HandProblem(HandLog log, const HandOptions& options);

  const std::vector<Parameter>& parameters() const override { return parameters_; }
  std::string unit() const override { return "m"; }
  std::size_t stretches() const override { return begins_.size() - 1; }
  Stretch stretch(std::size_t index) const override;
  std::unique_ptr<ceres::CostFunction> cost(std::size_t stretch) const override;

  const std::vector<std::string>& warnings() const { return warnings_; }
  // The degree of the polynomial that replaces an unknown intended motion: the degrees of freedom
  // of a bandwidth B in a window L, 2·B·L (Slepian 1976), and three more for its ends.
  std::size_t degree() const { return degree_; }

 private:
  HandLog log_;
  std::size_t degree_ = 0;
  std::vector<std::size_t> begins_;  // the first samples of stretches, and the end
  std::vector<Parameter> parameters_;
  std::vector<std::string> warnings_;
};

}  // namespace hvp::fit
