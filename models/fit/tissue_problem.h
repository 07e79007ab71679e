#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "models/fit/problem.h"
#include "models/fit/tissue_proxy.h"
#include "models/fit/tissue_response.h"
#include "models/fit/tissue_system.h"

namespace hvp::fit {

// The log of one touch, from before it, or its first moment, to before its end. The body is at rest
// and unloaded when the log begins.
struct TissueLog {
  std::vector<int> nodes;  // nodes of the mesh, ascending, that move together
  Eigen::Vector3d direction = Eigen::Vector3d(0, 0, -1);  // of any length; into the body
  std::vector<double> time;                               // s, evenly spaced
  std::vector<double> displacement;  // m, along the direction; of a proxy that of its tip from X
  // N, on the body along the direction: positive where the displacement is. A log with the sign of
  // the force on the hand is reversed, with a warning.
  std::vector<double> force;
  // In place of the nodes: the contact is a proxy, which the tip pulls at, so that the body may
  // also be pressed aside.
  std::optional<ProxyPath> proxy = {};
};

// The problem of finding E, ν and Rayleigh's α and β (for a static body only E and ν) of the
// platform's finite-element body from touches. The force is that of a double-precision solution
// with the servo loop's time integration (tissue_response.h). Each log is one stretch without
// unknowns of its own.
//
// Parameters: "young_modulus" (Pa, logarithmic), "poisson_ratio", "mass_damping" (1/s),
// "stiffness_damping" (s). The force on a static body is proportional to one function of E and ν,
// so that one contact gives either of them and two contacts give both.
class TissueProblem final : public Problem {
 public:
  // Throws InputError for a body or a contact that TissueSystem refuses, unstable Newmark settings,
  // and a log that is too short, not evenly spaced, not finite, does not move, moves by more than
  // the body's width, or has a force that no material gives.
  TissueProblem(TissueBody body, const std::vector<TissueLog>& logs);
  ~TissueProblem() override;

  const std::vector<Parameter>& parameters() const override { return parameters_; }
  std::string unit() const override { return "N"; }
  std::size_t stretches() const override { return touches_.size(); }
  Stretch stretch(std::size_t index) const override;
  std::unique_ptr<ceres::CostFunction> cost(std::size_t stretch) const override;

  const TissueBody& body() const { return *body_; }
  // The repairs of the logs, and cautions.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  struct Touch;
  class Cost;

  Touch make_touch(const TissueLog& log, std::size_t number);
  double start_of_young_modulus() const;
  void declare_parameters();

  std::shared_ptr<const TissueBody> body_;
  // Of logs whose contact is a proxy.
  std::shared_ptr<ProxyPlaces> places_;
  std::shared_ptr<const TissueSystem> untouched_;
  std::vector<std::shared_ptr<const Touch>> touches_;
  std::vector<Parameter> parameters_;
  std::vector<std::string> warnings_;
};

// A checked log in the form that the model takes, with a warning for each thing that was repaired
// or is doubtful. `name` begins every sentence ("log 2"). Throws InputError as TissueProblem does.
TissueLog checked_log(const TissueBody& body, TissueLog log, const std::string& name,
                      std::vector<std::string>& warnings);

}  // namespace hvp::fit
