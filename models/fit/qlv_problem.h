#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "models/fit/problem.h"

namespace hvp::fit {

// The record of an indenter that is pressed into tissue: its travel and the force. The record
// begins before contact, or long after any load. Sign and origin of the travel do not matter.
struct IndentationLog {
  std::vector<double> time;    // s
  std::vector<double> travel;  // m
  std::vector<double> force;   // N
};

// The same, with force and depth growing as the indenter is pressed. It begins with the last sample
// before the indenter moves, because on real machines the zero of the force jumps as the drive
// starts, by 10 to 16 mN in five of six records of one, and a model of the tissue should not
// account for that.
struct PressedLog {
  std::vector<double> time;   // s
  std::vector<double> depth;  // m, direction · travel
  std::vector<double> force;  // N
  double direction = 1;       // 1 or −1
  double step = 0;            // s, the median
  std::vector<std::string> warnings;

  double stroke() const;          // m
  double force_range() const;     // N
  double seconds() const;         // s, from the first sample to the last
  double shallowest() const;      // m, the least `depth`
  double deepest() const;         // m
  double before_contact() const;  // N, the force at the beginning
  double first_loaded() const;    // m, the depth where the force has begun to rise
};

// Prepares a record. Throws InputError: fewer than 20 samples, columns of different lengths,
// numbers that are not finite, time steps that are not even, no motion, no change of force, lengths
// or forces that look like another unit.
PressedLog pressed(const IndentationLog& log);

enum class Elastic {
  fung,  // c·(e^(qδ) − 1)/q
  power  // c·δⁿ
};

struct QlvSettings {
  Elastic elastic = Elastic::fung;
  int exponentials = 2;  // terms of the reduced relaxation, 1 to 3
};

// Soft tissue under an indenter, from a record that presses and then holds; the equations are in
// qlv_response.h. The parameters are, in this order: c, q (or n), g1, tau1, … in the order of tau,
// contact (m, in the log's own travel), offset (N). The model has no value unless tau1 < tau2 < …
// and Σg ≤ 1, so that no start ends in the same optimum with its exponentials exchanged. A contact
// before the record's first place is taken to be there.
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

// The model's force (N) at each sample of the log, whose own force is not read. `values` are
// QlvProblem's parameters. Throws std::invalid_argument where their number is wrong or the model
// has no value.
std::vector<double> qlv_force(const QlvSettings& settings, const PressedLog& log,
                              const std::vector<double>& values);

// The relaxation of a load: the force above the offset divided by that at the end of the ramp.
struct NormalisedRelaxation {
  std::vector<double> time;   // s, from the end of the ramp on
  std::vector<double> share;  // 1 at its beginning
};

// The normalised relaxation of forces along the log. The ramp ends where the depth is first within
// a hundredth of the stroke of its deepest. Throws InputError where fewer than ten samples follow.
NormalisedRelaxation normalised_relaxation(const PressedLog& log, const std::vector<double>& force,
                                           double offset);

// The parameters of a record, with starts and bounds that follow from its stroke, its force and its
// length: a record does not show a time constant below half a step or above ten times its length.
std::vector<Parameter> qlv_parameters(const QlvSettings& settings, const PressedLog& log);

// Sets the start of the search to the best contact. The stiffness jumps where the indenter touches,
// so that the sum of squares has a local minimum between any two samples of the first part of the
// ramp. Contacts are tried there one after the other and the rest is fitted; `parameters` then
// begin at the best, with further contacts drawn from around it. Where the best is the first place
// of all, the tissue was touched before the indenter moved: the contact may then lie further out,
// where it changes nothing, and so is reported as not identifiable.
void begin_at_best_contact(const Problem& problem, const PressedLog& log,
                           std::vector<Parameter>& parameters);

}  // namespace hvp::fit
