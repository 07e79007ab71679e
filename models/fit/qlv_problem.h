#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "models/fit/problem.h"
#include "models/fit/qlv_log.h"

namespace hvp::fit {

enum class Elastic {
  fung,  // c·(e^(qδ) − 1)/q
  power  // c·δⁿ
};

struct QlvSettings {
  Elastic elastic = Elastic::fung;
  int exponentials = 2;  // of the reduced relaxation, 1 to 3
};

// Soft tissue under an indenter, from a record that presses and holds: qlv_response.h says the
// equations. Parameters in order: c, q (or n), g1, tau1, … in the order of tau, contact (m, in the
// log's own travel), offset (N). The model has no value unless tau1 < tau2 < … and Σg ≤ 1, so that
// no start ends in the same optimum with its exponentials exchanged. A contact before the first
// place of the record counts as there.
class QlvProblem : public Problem {
 public:
  // Throws InputError: what pressed() throws, exponentials other than 1 to 3.
  QlvProblem(const QlvSettings& settings, const IndentationLog& log);

  const std::vector<Parameter>& parameters() const override { return parameters_; }
  std::string unit() const override { return "N"; }
  double signal_rms() const override;
  std::size_t stretches() const override { return 1; }
  Stretch stretch(std::size_t index) const override;
  std::unique_ptr<ceres::CostFunction> cost(std::size_t stretch) const override;

  const PressedLog& log() const { return *log_; }
  const std::vector<std::string>& warnings() const { return log_->warnings; }

 private:
  QlvSettings settings_;
  std::shared_ptr<const PressedLog> log_;
  std::vector<Parameter> parameters_;
};

// Force (N) that the model has at each sample of the log, whose own force is not read. `values` as
// QlvProblem's parameters. Throws std::invalid_argument where their number is another one, or the
// model has no value.
std::vector<double> qlv_force(const QlvSettings& settings, const PressedLog& log,
                              const std::vector<double>& values);

// How a load relaxes: force above the offset over that at the end of the ramp.
struct NormalisedRelaxation {
  std::vector<double> time;   // s, from the end of the ramp on
  std::vector<double> share;  // 1 at its beginning
};

// Of forces along the log: the end of the ramp is where the depth first is within a hundredth of
// the stroke from its deepest. Throws InputError where fewer than ten samples follow.
NormalisedRelaxation normalised_relaxation(const PressedLog& log, const std::vector<double>& force,
                                           double offset);

}  // namespace hvp::fit
