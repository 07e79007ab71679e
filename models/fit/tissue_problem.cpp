#include "models/fit/tissue_problem.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>

#include <ceres/cost_function.h>
#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::fit {
namespace {

// Soft tissue is nearly incompressible: the default of object.material.poisson_ratio, below.
constexpr double kStartPoisson = 0.4;
constexpr double kHighestPoisson = 0.499;
// The range of object.material.young_modulus, Pa.
constexpr double kSoftest = 1;
constexpr double kStiffest = 1e13;
// The range of materials in a haptic scene, from a gel to rubber; beyond it a unit is suspected.
constexpr double kSoftTissue = 100;
constexpr double kRubber = 1e9;

}  // namespace

// A log as its cost function needs it.
struct TissueProblem::Touch {
  std::vector<int> nodes;
  Eigen::Vector3d direction;
  std::shared_ptr<const TissueSystem> system;  // of a proxy: the body without a contact
  ContactMotion motion;
  std::shared_ptr<const ProxyPlaces> places;  // of a proxy
  ProxyTouch proxy;
  std::vector<double> force;

  std::optional<TissueForce> static_response(const TissueValues& values, bool derivatives) const {
    return places ? static_proxy_force(*places, proxy, values, derivatives)
                  : static_force(*system, values, motion, derivatives);
  }
  std::optional<TissueForce> response(const TissueBody& body, const TissueValues& values,
                                      bool derivatives) const {
    if (!body.dynamics) return static_response(values, derivatives);
    return places ? dynamic_proxy_force(*system, body, *places, proxy, values, derivatives)
                  : dynamic_force(*system, body, values, motion, derivatives);
  }
};

class TissueProblem::Cost final : public ceres::CostFunction {
 public:
  Cost(std::shared_ptr<const TissueBody> body, std::shared_ptr<const Touch> touch)
      : body_(std::move(body)), touch_(std::move(touch)) {
    set_num_residuals(static_cast<int>(touch_->force.size()));
    mutable_parameter_block_sizes()->push_back(body_->dynamics ? 4 : 2);
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const double* p = parameters[0];
    const TissueValues values = {p[0], p[1], body_->dynamics ? p[2] : 0,
                                 body_->dynamics ? p[3] : 0};
    if (!(values.young_modulus > 0) || !(values.poisson_ratio > -1) ||
        !(values.poisson_ratio < 0.5)) {
      return false;
    }
    double* jacobian = jacobians != nullptr ? jacobians[0] : nullptr;
    const std::optional<TissueForce> model = touch_->response(*body_, values, jacobian != nullptr);
    if (!model) return false;
    const std::vector<double>& force = touch_->force;
    for (std::size_t i = 0; i < force.size(); ++i) {
      residuals[i] = force[i] - model->force[i];
      if (!std::isfinite(residuals[i])) return false;
    }
    return jacobian == nullptr || fill(*model, jacobian);
  }

 private:
  bool fill(const TissueForce& model, double* jacobian) const {
    const std::array columns = {&model.by_young_modulus, &model.by_poisson_ratio,
                                &model.by_mass_damping, &model.by_stiffness_damping};
    const std::size_t width = body_->dynamics ? 4 : 2;
    for (std::size_t i = 0; i < touch_->force.size(); ++i) {
      for (std::size_t c = 0; c < width; ++c) {
        jacobian[width * i + c] = -(*columns[c])[i];
        if (!std::isfinite(jacobian[width * i + c])) return false;
      }
    }
    return true;
  }

  std::shared_ptr<const TissueBody> body_;
  std::shared_ptr<const Touch> touch_;
};

TissueProblem::TissueProblem(TissueBody body, const std::vector<TissueLog>& logs)
    : body_(std::make_shared<const TissueBody>(std::move(body))) {
  if (body_->dynamics) {
    body_->dynamics->check();
    if (body_->dynamics->scheme != fem::Scheme::newmark) {
      throw InputError("dynamics.scheme",
                       "what is fitted moves by Newmark's rule: expected \"newmark\"");
    }
    if (!(body_->period_s > 0) || !std::isfinite(body_->period_s)) {
      throw InputError(
          fmt::format("the servo period is {} s; expected more than 0", body_->period_s));
    }
  }
  if (logs.empty()) throw InputError("no log of a contact; expected at least one");
  for (std::size_t i = 0; i < logs.size(); ++i) {
    touches_.push_back(std::make_shared<const Touch>(make_touch(logs[i], i + 1)));
  }
  declare_parameters();
}

TissueProblem::~TissueProblem() = default;

TissueProblem::Touch TissueProblem::make_touch(const TissueLog& log, std::size_t number) {
  const TissueLog checked = checked_log(*body_, log, fmt::format("log {}", number), warnings_);
  Touch touch;
  touch.nodes = checked.nodes;
  touch.direction = checked.direction;
  touch.force = checked.force;
  if (checked.proxy) {
    if (!places_) {
      places_ = std::make_shared<ProxyPlaces>(*body_);
      untouched_ = std::make_shared<const TissueSystem>(*body_);
    }
    touch.system = untouched_;
    touch.places = places_;
    touch.proxy = proxy_touch(*places_, *checked.proxy, checked.direction, checked.time.size());
    return touch;
  }
  for (const auto& other : touches_) {
    if (!other->places && other->nodes == touch.nodes && other->direction == touch.direction) {
      touch.system = other->system;
    }
  }
  if (!touch.system) {
    touch.system = std::make_shared<const TissueSystem>(*body_, touch.nodes, touch.direction);
  }
  touch.motion = contact_motion(*body_, checked.displacement);
  return touch;
}

// The start is that of a body without inertia, by least squares over all logs: F = E·s(ν)·x.
double TissueProblem::start_of_young_modulus() const {
  double along = 0;
  double square = 0;
  for (const auto& touch : touches_) {
    const std::optional<TissueForce> unit = touch->static_response({1, kStartPoisson, 0, 0}, false);
    if (!unit) throw InputError("the body's stiffness is not positive definite at a contact");
    for (std::size_t i = 0; i < touch->force.size(); ++i) {
      along += unit->force[i] * touch->force[i];
      square += unit->force[i] * unit->force[i];
    }
  }
  return along / square;
}

void TissueProblem::declare_parameters() {
  const double modulus = start_of_young_modulus();
  if (!(modulus >= kSoftest) || !(modulus <= kStiffest)) {
    throw InputError(fmt::format(
        "force_N over the displacement is that of a body with E = {:.3g} Pa; expected {:.3g} to "
        "{:.3g} Pa: newtons and metres, at the node that was touched",
        modulus, kSoftest, kStiffest));
  }
  if (modulus < kSoftTissue || modulus > kRubber) {
    warnings_.push_back(
        fmt::format("force_N over the displacement is that of a body with E = "
                    "{:.3g} Pa: no soft tissue; are the units N and m?",
                    modulus));
  }
  double omega = 1;
  if (body_->dynamics) {
    omega = lowest_frequency(*touches_.front()->system, modulus, kStartPoisson);
    if (!(omega > 0)) throw InputError("the body's mass is zero; expected a density above 0");
  }
  const std::string second = "a second contact elsewhere, or ";
  parameters_.push_back({.name = "young_modulus",
                         .unit = "Pa",
                         .start = modulus,
                         .low = kSoftest,
                         .high = kStiffest,
                         .because = "the range of object.material.young_modulus",
                         .logarithmic = true,
                         .draw_low = std::max(kSoftest, 0.1 * modulus),
                         .draw_high = std::min(kStiffest, 10 * modulus),
                         .matters = 0.1 * modulus,
                         .remedy = second + "ν from another source (--fix poisson_ratio=…)"});
  parameters_.push_back(
      {.name = "poisson_ratio",
       .unit = "",
       .start = kStartPoisson,
       .low = 0,
       .high = kHighestPoisson,
       .because = "no tissue widens when it is pulled, and at one half the volume cannot change: "
                  "the mesh locks",
       .logarithmic = false,
       .draw_low = 0.05,
       .draw_high = 0.48,
       .matters = 0.1,
       .remedy = second + "E from another source (--fix young_modulus=…)"});
  if (!body_->dynamics) return;
  // The damping ratio of a mode of angular frequency ω is α/(2ω) + βω/2.
  const double hertz = omega / (2 * std::numbers::pi);
  parameters_.push_back(
      {.name = "mass_damping",
       .unit = "1/s",
       .start = 0.04 * omega,
       .low = 0,
       .high = 1e6,
       .because = "damping takes energy; the range of dynamics.rayleigh_mass",
       .logarithmic = false,
       .draw_low = 0,
       .draw_high = 0.4 * omega,
       .matters = 0.02 * omega,
       .remedy =
           fmt::format("a motion at frequencies f with 2πf near {:.3g} rad/s (f = {:.3g} Hz), "
                       "the body's lowest, where α damps most",
                       omega, hertz)});
  parameters_.push_back(
      {.name = "stiffness_damping",
       .unit = "s",
       .start = 0.04 / omega,
       .low = 0,
       .high = 1e3,
       .because = "damping takes energy; the range of dynamics.rayleigh_stiffness",
       .logarithmic = false,
       .draw_low = 0,
       .draw_high = 0.4 / omega,
       .matters = 0.02 / omega,
       .remedy = fmt::format("a motion at frequencies f with 2πf near {:.3g} rad/s (f = {:.3g} Hz) "
                             "and above: a tap, or a quick press",
                             omega, hertz)});
}

Problem::Stretch TissueProblem::stretch(std::size_t index) const {
  return {touches_.at(index)->force.size(), {}};
}

std::unique_ptr<ceres::CostFunction> TissueProblem::cost(std::size_t stretch) const {
  return std::make_unique<Cost>(body_, touches_.at(stretch));
}

}  // namespace hvp::fit
