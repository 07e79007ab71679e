#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "app/fit/fit_request.h"
#include "models/config/declaration.h"
#include "models/config/input_error.h"
#include "models/fit/device_problem.h"
#include "models/fit/hand_problem.h"

namespace hvp::app {

namespace {

struct DeviceFitSettings {
  double window_s = 0.25;
  bool lag = false;

  void declare(config::Visitor& v) {
    v.quantity("window", window_s, config::Dimension::time, config::between(0.01, 60),
               {"each has a position and a velocity of its own to begin with",
                "long beside a device's mechanical time constant, short beside its drift"});
    v.boolean("lag", lag,
              {"the amplifier has a bandwidth, to be found",
               "off: one of 1 kHz moves a device of 0.1 kg by nothing that shows"});
  }
};

struct Columns {
  const files::LogColumn* command = nullptr;
  const files::LogColumn* position = nullptr;
  fit::DeviceMotionKind motion = fit::DeviceMotionKind::linear;
  fit::DeviceCommand kind = fit::DeviceCommand::force;
};

// Chooses the columns by their units: force or torque, metres or radians.
Columns columns_of(const files::Log& log) {
  Columns c;
  for (const char* name : {"position", "travel", "displacement", "angle"}) {
    if (c.position == nullptr) c.position = log.find(name);
  }
  if (c.position == nullptr) c.position = &log.column("position", "m");
  c.motion =
      c.position->unit == "rad" ? fit::DeviceMotionKind::rotary : fit::DeviceMotionKind::linear;
  if (c.motion == fit::DeviceMotionKind::linear) {
    c.position = &log.column(c.position->quantity, "m");
  }
  c.command = log.find("current");
  if (c.command != nullptr) {
    c.kind = fit::DeviceCommand::current;
    c.command = &log.column("current", "A");
  } else if (c.motion == fit::DeviceMotionKind::rotary) {
    c.command = &log.column("torque", "N m");
  } else {
    c.command = &log.column("force", "N");
  }
  return c;
}

// True if the axis moved forwards and back by similar amounts, not counting steps below `step`.
// Friction and offset can be distinguished in no other way.
bool reverses(const std::vector<double>& position, double step) {
  constexpr double kShare = 0.02;
  double forwards = 0;
  double back = 0;
  double last = position.front();
  for (const double p : position) {
    if (std::abs(p - last) < step) continue;
    (p > last ? forwards : back) += std::abs(p - last);
    last = p;
  }
  return std::min(forwards, back) > kShare * std::max(forwards, back);
}

void mark(fit::Fit& fit, FitFigures& figures, const std::vector<std::string>& names,
          const std::string& remedy) {
  std::string all;
  for (fit::Estimate& e : fit.parameters) {
    if (std::find(names.begin(), names.end(), e.name) == names.end()) continue;
    e.identifiable = false;
    e.remedy = remedy;
    all += (all.empty() ? "" : ", ") + e.name;
  }
  figures.warnings.push_back(fmt::format("this log does not give {}: {}", all, remedy));
}

// Warns of what the covariance does not show: two parameters of which the log determines only one,
// and wrong units.
void look_again(const fit::DeviceProblem& problem, const Columns& columns, bool mass_known,
                FitFigures& figures) {
  fit::Fit& fit = figures.fit;
  constexpr double kSteps = 5;
  const double seen = std::max(kSteps * fit.residual_rms, 0.0);
  if (!reverses(columns.position->values, seen)) {
    mark(fit, figures, {"coulomb", "offset"},
         "a motion that reverses, friction alone or offset alone");
  }
  if (columns.kind == fit::DeviceCommand::current && !mass_known) {
    mark(fit, figures, {problem.mass_name(), "damping", "coulomb", "offset", "motor_constant"},
         "values are for a motor constant of one: weigh it, or --fix motor_constant=…");
  }
  const double mass = estimate(fit, problem.mass_name()).value;
  if (columns.motion == fit::DeviceMotionKind::linear && (mass > 20 || mass < 1e-3)) {
    figures.warnings.push_back(
        fmt::format("a device of {:.3g} kg: are the columns in the units that they name?", mass));
  }
  const auto [least, most] =
      std::minmax_element(columns.position->values.begin(), columns.position->values.end());
  if (columns.motion == fit::DeviceMotionKind::linear && *most - *least > 2) {
    figures.warnings.push_back(
        fmt::format("a stroke of {:.3g} m: is the position in mm?", *most - *least));
  }
}

std::vector<FittedSetting> settings_of(const fit::Fit& fit, const fit::DeviceOptions& options) {
  std::vector<FittedSetting> settings;
  if (options.motion == fit::DeviceMotionKind::rotary) return settings;
  const auto add = [&](const char* table, const char* key, const char* name, const char* unit) {
    settings.push_back({table, key, toml_quantity(estimate(fit, name).value, unit), name});
  };
  add("device.dynamics", "mass", "mass", "kg");
  add("device.dynamics", "damping", "damping", "N s/m");
  if (estimate(fit, "coulomb").value > 0) add("device.friction", "force", "coulomb", "N");
  const bool current = options.command == fit::DeviceCommand::current;
  if (options.lag && current) add("device.amplifier", "bandwidth", "bandwidth", "Hz");
  if (current) {
    // N/A at a lever of one metre equals N·m/A.
    add("device.motor", "torque_constant", "motor_constant", "N m/A");
    settings.push_back({"device.motor", "transmission", "[1, 1, 1]", "motor_constant"});
    settings.push_back({"device.motor", "lever", "\"1 m\"", "motor_constant"});
  }
  return settings;
}

}  // namespace

FitOutcome fit_device(const FitRequest& request) {
  const auto settings = model_settings<DeviceFitSettings>(request.overrides);
  const files::Log log = longest_stretch(
      request.read({"force", "torque", "current", "position", "travel", "displacement", "angle"}),
      request);
  const Columns columns = columns_of(log);
  fit::DeviceOptions options;
  options.motion = columns.motion;
  options.command = columns.kind;
  options.lag = settings.lag;
  options.window = settings.window_s;
  options.fixed = request.options.fixed;
  const fit::DeviceProblem problem(
      {log.spacing.period, columns.command->values, columns.position->values}, options);
  fit::Options fitting = request.options;
  fitting.fixed = problem.fixed();

  FitOutcome outcome;
  outcome.figures =
      figures_of("device", log, problem.unit(), fit::fit(problem, fitting), problem.warnings());
  const std::map<std::string, double>& known = request.options.fixed;
  look_again(problem, columns,
             known.count("motor_constant") > 0 || known.count(problem.mass_name()) > 0,
             outcome.figures);
  const fit::Fit& fit = outcome.figures.fit;
  outcome.settings_of = [options](const fit::Fit& of) { return settings_of(of, options); };
  outcome.settings = outcome.settings_of(fit);
  outcome.plot = {"time (s)", columns.position->quantity, columns.position->unit, {}, {}, {}};
  outcome.plot.add_stretches(log.time, columns.position->values, fit.residuals, problem.first());
  return outcome;
}

namespace {

struct HandFitSettings : fit::HandOptions {
  void declare(config::Visitor& v) {
    v.quantity("window", window, config::Dimension::time, config::between(0.05, 60),
               {"each has a position and a velocity of its own to begin with",
                "two periods of a hand's slowest own motion"});
    v.quantity("bandwidth", bandwidth, config::Dimension::frequency, config::between(0, 20),
               {"of an intended motion that is not in the log",
                "voluntary motion of an arm is mostly below 2 Hz"});
  }
};

}  // namespace

FitOutcome fit_hand(const FitRequest& request) {
  const auto settings = model_settings<HandFitSettings>(request.overrides);
  const files::Log log =
      longest_stretch(request.read({"force", "position", "displacement", "intended"}), request);
  const files::LogColumn& position =
      log.column(log.find("displacement") != nullptr ? "displacement" : "position", "m");
  fit::HandLog hand{log.spacing.period, log.column("force", "N").values, position.values, {}};
  if (log.find("intended") != nullptr) hand.intended = log.column("intended", "m").values;
  const fit::HandProblem problem(hand, settings);

  FitOutcome outcome;
  outcome.figures = figures_of("hand", log, problem.unit(), fit::fit(problem, request.options),
                               problem.warnings());
  const fit::Fit& fit = outcome.figures.fit;
  outcome.settings_of = [](const fit::Fit& of) {
    std::vector<FittedSetting> all = {{"hand", "model", "\"custom\"", ""}};
    for (const auto& [key, unit] :
         {std::pair{"mass", "kg"}, {"stiffness", "N/m"}, {"damping", "N s/m"}}) {
      all.push_back({"hand", key, toml_quantity(estimate(of, key).value, unit), key});
    }
    return all;
  };
  outcome.settings = outcome.settings_of(fit);
  outcome.plot = {"time (s)", "position", "m", {}, {}, {}};
  outcome.plot.add_stretches(log.time, position.values, fit.residuals);
  return outcome;
}

}  // namespace hvp::app
