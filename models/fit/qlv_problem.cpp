#include "models/fit/qlv_problem.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <ceres/autodiff_cost_function.h>
#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fit/qlv_response.h"

namespace hvp::fit {

namespace {

constexpr int kMostExponentials = 3;
// Above it the exponential is no elasticity any more, and soon no number.
constexpr double kSteepest = 200;  // q·δ

// Force at each sample; false where the model has no value. `values` in QlvProblem's order.
template <int Exponentials, class T>
bool force_of(Elastic elastic, const PressedLog& log, const T* values, T* out) {
  constexpr auto kCount = static_cast<std::size_t>(Exponentials);
  std::array<Relaxation<T>, kCount> relaxation{};
  T left(1.0);
  for (std::size_t i = 0; i < kCount; ++i) {
    relaxation[i] = {values[2 + 2 * i], values[3 + 2 * i]};
    if (!(relaxation[i].tau > 0.0)) return false;
    if (i > 0 && !(relaxation[i].tau > relaxation[i - 1].tau)) return false;
    left -= relaxation[i].share;
  }
  if (left < 0.0) return false;
  T contact = log.direction * values[2 + 2 * kCount];
  // The load before the record is not known, so that a contact further out counts as none.
  const double first = log.shallowest();
  if (contact < first) contact = T(first);
  const T& offset = values[3 + 2 * kCount];
  if (elastic == Elastic::power) {
    qlv_response(log, PowerElasticity<T>{values[0], values[1]}, relaxation, contact, offset, out);
    return true;
  }
  if (values[1] * (log.deepest() - contact) > kSteepest) return false;
  qlv_response(log, FungElasticity<T>{values[0], values[1]}, relaxation, contact, offset, out);
  return true;
}

template <int Exponentials>
struct ForceResidual {
  Elastic elastic = Elastic::fung;
  std::shared_ptr<const PressedLog> log;

  template <class T>
  bool operator()(const T* values, T* residuals) const {
    if (!force_of<Exponentials>(elastic, *log, values, residuals)) return false;
    for (std::size_t i = 0; i < log->force.size(); ++i) {
      residuals[i] = log->force[i] - residuals[i];
    }
    return true;
  }
};

template <int Exponentials>
std::unique_ptr<ceres::CostFunction> cost_of(Elastic elastic,
                                             std::shared_ptr<const PressedLog> log) {
  const auto rows = static_cast<int>(log->force.size());
  using Residual = ForceResidual<Exponentials>;
  return std::make_unique<
      ceres::AutoDiffCostFunction<Residual, ceres::DYNAMIC, 4 + 2 * Exponentials>>(
      new Residual{elastic, std::move(log)}, rows);
}

}  // namespace

QlvProblem::QlvProblem(const QlvSettings& settings, const IndentationLog& log)
    : settings_(settings) {
  if (settings.exponentials < 1 || settings.exponentials > kMostExponentials) {
    throw InputError("exponentials", fmt::format("expected 1 to {}, found {}", kMostExponentials,
                                                 settings.exponentials));
  }
  log_ = std::make_shared<const PressedLog>(pressed(log));
  parameters_ = qlv_parameters(settings, *log_);
  begin_at_best_contact(*this, *log_, parameters_);
}

double QlvProblem::signal_rms() const {
  double mean = 0;
  for (const double force : log_->force) mean += force;
  mean /= static_cast<double>(log_->force.size());
  double squares = 0;
  for (const double force : log_->force) squares += (force - mean) * (force - mean);
  return std::sqrt(squares / static_cast<double>(log_->force.size()));
}

Problem::Stretch QlvProblem::stretch(std::size_t /*index*/) const {
  return {.residuals = log_->force.size(), .own = {}};
}

std::unique_ptr<ceres::CostFunction> QlvProblem::cost(std::size_t /*stretch*/) const {
  switch (settings_.exponentials) {
    case 1:
      return cost_of<1>(settings_.elastic, log_);
    case 2:
      return cost_of<2>(settings_.elastic, log_);
    default:
      return cost_of<3>(settings_.elastic, log_);
  }
}

std::vector<double> qlv_force(const QlvSettings& settings, const PressedLog& log,
                              const std::vector<double>& values) {
  if (values.size() != 4 + 2 * static_cast<std::size_t>(settings.exponentials)) {
    throw std::invalid_argument("qlv_force: another number of values than of parameters");
  }
  std::vector<double> force(log.depth.size());
  bool valid = false;
  switch (settings.exponentials) {
    case 1:
      valid = force_of<1>(settings.elastic, log, values.data(), force.data());
      break;
    case 2:
      valid = force_of<2>(settings.elastic, log, values.data(), force.data());
      break;
    case 3:
      valid = force_of<3>(settings.elastic, log, values.data(), force.data());
      break;
    default:
      break;
  }
  if (!valid) throw std::invalid_argument("qlv_force: no value at these parameters");
  return force;
}

NormalisedRelaxation normalised_relaxation(const PressedLog& log, const std::vector<double>& force,
                                           double offset) {
  constexpr double kNear = 0.01;  // of the stroke
  constexpr std::size_t kFewestSeen = 10;
  const double reached = log.deepest() - kNear * log.stroke();
  const auto end_of_ramp = std::find_if(log.depth.begin(), log.depth.end(),
                                        [&](double depth) { return depth >= reached; });
  const auto begin = static_cast<std::size_t>(end_of_ramp - log.depth.begin());
  if (log.depth.size() - begin < kFewestSeen) {
    throw InputError(
        fmt::format("travel: {} samples at its far end; expected a hold of at least {}",
                    log.depth.size() - begin, kFewestSeen));
  }
  NormalisedRelaxation result;
  for (std::size_t i = begin; i < force.size(); ++i) {
    result.time.push_back(log.time[i] - log.time[begin]);
    result.share.push_back((force[i] - offset) / (force[begin] - offset));
  }
  return result;
}

}  // namespace hvp::fit
