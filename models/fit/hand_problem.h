#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "models/fit/hand_cost.h"
#include "models/fit/problem.h"

namespace hvp::fit {

struct HandOptions {
  double window = 0.5;   // s, of a stretch
  double bandwidth = 2;  // Hz, of an intended motion that is not in the log
};

// A hand with mass m on a spring and a damper between it and the motion u that it intends:
//
//   m·x″ = F − b·(x′ − u′) − k·(x − u)
//
// F is the force on the hand. Parameters, in this order: mass (kg), stiffness (N/m), damping
// (N·s/m). Residuals are positions, over windows, each beginning with a position and a velocity of
// its own; where u is not in the log it is a polynomial of its own in each window (hand_cost()).
class HandProblem final : public Problem {
 public:
  // Throws InputError as check_columns() does, and where position and force do not belong to a
  // mass on a spring.
  HandProblem(HandLog log, const HandOptions& options);

  const std::vector<Parameter>& parameters() const override { return parameters_; }
  std::string unit() const override { return "m"; }
  std::size_t stretches() const override { return begins_.size() - 1; }
  Stretch stretch(std::size_t index) const override;
  std::unique_ptr<ceres::CostFunction> cost(std::size_t stretch) const override;

  const std::vector<std::string>& warnings() const { return warnings_; }
  // Of the polynomial that stands for an unknown intended motion: what a bandwidth B and a window L
  // leave free, 2·B·L (Slepian 1976), and three more for its ends.
  std::size_t degree() const { return degree_; }

 private:
  HandLog log_;
  std::size_t degree_ = 0;
  std::vector<std::size_t> begins_;  // of stretches; one more, the end
  std::vector<Parameter> parameters_;
  std::vector<std::string> warnings_;
};

}  // namespace hvp::fit
