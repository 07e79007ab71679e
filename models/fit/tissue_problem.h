#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "models/fit/problem.h"
#include "models/fit/tissue_response.h"
#include "models/fit/tissue_system.h"

namespace hvp::fit {

// One touch, from before it, or its first moment, to before its end: the body is at rest and
// unloaded when the log begins.
struct TissueLog {
  std::vector<int> nodes;  // of the mesh, ascending, which move together
  Eigen::Vector3d direction = Eigen::Vector3d(0, 0, -1);  // any length; into the body
  std::vector<double> time;                               // s, evenly spaced
  std::vector<double> displacement;                       // m, along the direction
  // N, on the body along the direction: positive where the displacement is. One that has the sign
  // of the force on the hand is turned round, with a warning.
  std::vector<double> force;
};

// E, ν and Rayleigh's α and β (of a static body the first two) of the platform's finite-element
// body, from touches. The force is that of a double-precision solution with the servo loop's time
// integration; see tissue_response.h. One stretch a log, without unknowns of its own.
//
// Parameters: "young_modulus" (Pa, logarithmic), "poisson_ratio", "mass_damping" (1/s),
// "stiffness_damping" (s). A force is proportional to a function of E and ν where the body is
// static, so that one contact gives either, and two contacts give both.
class TissueProblem final : public Problem {
 public:
  // Throws InputError for a body or a contact that TissueSystem refuses, unstable Newmark settings,
  // and a log that is too short, not even, not finite, does not move, moves by more than the body
  // is wide, or whose force is that of no material.
  TissueProblem(TissueBody body, const std::vector<TissueLog>& logs);
  ~TissueProblem() override;

  const std::vector<Parameter>& parameters() const override { return parameters_; }
  std::string unit() const override { return "N"; }
  std::size_t stretches() const override { return touches_.size(); }
  Stretch stretch(std::size_t index) const override;
  std::unique_ptr<ceres::CostFunction> cost(std::size_t stretch) const override;

  const TissueBody& body() const { return *body_; }
  // What was repaired in the logs, and what to beware of.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  struct Touch;
  class Cost;

  Touch make_touch(const TissueLog& log, std::size_t number);
  double start_of_young_modulus() const;
  void declare_parameters();

  std::shared_ptr<const TissueBody> body_;
  std::vector<std::shared_ptr<const Touch>> touches_;
  std::vector<Parameter> parameters_;
  std::vector<std::string> warnings_;
};

}  // namespace hvp::fit
