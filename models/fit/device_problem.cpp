#include "models/fit/device_problem.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "models/config/input_error.h"
#include "models/fit/device_log.h"

namespace hvp::fit {

namespace {

std::string rounded(double x) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", x);
  return text.data();
}

// The words and limits in which a linear and a rotary axis differ.
struct AxisKind {
  const char* mass;
  const char* mass_unit;
  const char* damping_unit;
  const char* force_unit;
  const char* motor_unit;
  const char* expected;
  double lightest, heaviest;
};
constexpr AxisKind kLinearAxis{"mass", "kg", "N·s/m", "N", "N/A", "N (or A) and m", 1e-7, 1000};
// The rotor of the smallest motors has some 1e-9 kg·m².
constexpr AxisKind kRotaryAxis{
    "inertia", "kg·m²", "N·m·s/rad", "N·m", "N·m/A", "N·m (or A) and rad", 1e-10, 100};

Parameter mass(const AxisKind& kind, const DeviceSecondOpinion& opinion, double scale) {
  const double start = opinion.mass * scale;
  if (!(start >= kind.lightest && start <= kind.heaviest)) {
    throw InputError("a regression gives " + std::string(kind.mass) + " = " + rounded(start) + " " +
                     kind.mass_unit + ", beyond " + rounded(kind.lightest) + " to " +
                     rounded(kind.heaviest) + ": command and position are expected in " +
                     kind.expected);
  }
  Parameter p;
  p.name = kind.mass;
  p.unit = kind.mass_unit;
  p.start = start;
  p.low = kind.lightest;
  p.high = kind.heaviest;
  p.because = "no haptic device is lighter or heavier";
  p.logarithmic = true;
  p.draw_low = std::max(p.low, start / kDrawFactor);
  p.draw_high = std::min(p.high, start * kDrawFactor);
  p.matters = 0.1 * scale * opinion.command / opinion.acceleration;
  p.remedy = "a motion with acceleration: fast reversals or steps of force";
  return p;
}

Parameter damping(const AxisKind& kind, const DeviceSecondOpinion& opinion, double scale) {
  const double typical = scale * opinion.command / opinion.velocity;
  Parameter p;
  p.name = "damping";
  p.unit = kind.damping_unit;
  p.low = 0;
  p.high = 100 * scale * opinion.command_most / opinion.velocity;
  p.because = "it takes energy; it is less than a hundred times what the largest command overcomes";
  p.start = std::max(opinion.damping * scale, 0.01 * typical);
  p.draw_low = 0;
  p.draw_high = typical;
  p.matters = 0.1 * typical;
  p.remedy = "a motion at several speeds";
  return p;
}

Parameter coulomb(const AxisKind& kind, const DeviceSecondOpinion& opinion, double scale) {
  const double typical = scale * opinion.command;
  Parameter p;
  p.name = "coulomb";
  p.unit = kind.force_unit;
  p.low = 0;
  p.high = 10 * scale * opinion.command_most;
  p.because = "it takes energy; ten times the largest command is more than lets the axis move";
  p.start = std::max(opinion.coulomb * scale, 0.01 * typical);
  p.draw_low = 0;
  p.draw_high = 0.5 * typical;
  p.matters = 0.1 * typical;
  p.remedy = "a motion that reverses";
  return p;
}

Parameter offset(const AxisKind& kind, const DeviceSecondOpinion& opinion, double scale) {
  const double typical = scale * opinion.command;
  Parameter p;
  p.name = "offset";
  p.unit = kind.force_unit;
  p.high = 10 * scale * opinion.command_most;
  p.low = -p.high;
  p.because = "ten times the largest command would carry the axis away";
  p.start = std::clamp(opinion.offset * scale, p.low, p.high);
  p.draw_low = -0.3 * typical;
  p.draw_high = 0.3 * typical;
  p.matters = 0.1 * typical;
  p.remedy = "a motion that reverses";
  return p;
}

Parameter motor_constant(const AxisKind& kind, double scale) {
  Parameter p;
  p.name = "motor_constant";
  p.unit = kind.motor_unit;
  p.low = 1e-6;
  p.high = 1e4;
  p.start = std::clamp(scale, p.low, p.high);
  p.because = "no motor and drive of a haptic device lies beyond";
  p.logarithmic = true;
  p.draw_low = std::max(p.low, p.start / kDrawFactor);
  p.draw_high = std::min(p.high, p.start * kDrawFactor);
  p.matters = 0.1 * scale;
  p.remedy = std::string("a log of forces beside the current, or the ") + kind.mass +
             " weighed, or --fix motor_constant= from the motor's data sheet";
  return p;
}

Parameter bandwidth(double period) {
  Parameter p;
  p.name = "bandwidth";
  p.unit = "Hz";
  p.low = 2;
  p.high = std::max(2 / period, 10 * p.low);
  p.because =
      "a slower amplifier moves no haptic device; of a faster one nothing shows between samples";
  p.logarithmic = true;
  p.start = std::clamp(100.0, p.low, p.high);
  p.draw_low = std::clamp(20.0, p.low, p.high / 10);
  p.draw_high = p.high / 4;
  p.matters = 1;
  p.remedy = "a command with steps, or with frequencies near the bandwidth";
  return p;
}

Parameter delay(const DeviceSecondOpinion& opinion, bool lag, double start_bandwidth,
                double period) {
  constexpr double kTwoPi = 6.283185307179586;
  Parameter p;
  p.name = "delay";
  p.unit = "s";
  p.low = 0;
  p.high = kMostDelaySamples * period;
  p.because = "the command comes first; " + std::to_string(kMostDelaySamples) +
              " samples are more than a loop bears";
  p.start = std::min(
      lag ? std::max(0.0, opinion.delay - 1 / (kTwoPi * start_bandwidth)) : opinion.delay, p.high);
  p.draw_low = 0;
  p.draw_high = std::min(p.high, opinion.delay + 3 * period);
  p.matters = period;
  p.remedy = "a command with steps, or with frequencies near one over the delay";
  return p;
}

// Parameters of a device with their units, bounds, starts and remedies, in the layout's order.
// `scale`: the motor constant that starts assume; 1 for a command that is a force. Throws
// InputError where the regression's mass, times that, is no device's.
std::vector<Parameter> device_parameters(const DeviceSecondOpinion& opinion,
                                         const DeviceLayout& layout, DeviceMotionKind motion,
                                         double scale, double period) {
  const AxisKind& kind = motion == DeviceMotionKind::linear ? kLinearAxis : kRotaryAxis;
  std::vector<Parameter> parameters{mass(kind, opinion, scale), damping(kind, opinion, scale),
                                    coulomb(kind, opinion, scale), offset(kind, opinion, scale)};
  if (layout.motor_constant != DeviceLayout::kNone) {
    parameters.push_back(motor_constant(kind, scale));
  }
  const bool lag = layout.bandwidth != DeviceLayout::kNone;
  double start_bandwidth = 1;
  if (lag) {
    parameters.push_back(bandwidth(period));
    start_bandwidth = parameters.back().start;
  }
  parameters.push_back(delay(opinion, lag, start_bandwidth, period));
  return parameters;
}

// The motor constant that the starts assume, for a log of currents.
double motor_scale(const std::map<std::string, double>& fixed, const char* mass,
                   const DeviceSecondOpinion& opinion) {
  const auto constant = fixed.find("motor_constant");
  if (constant != fixed.end()) return constant->second;
  const auto weighed = fixed.find(mass);
  return weighed != fixed.end() ? weighed->second / opinion.mass : 1;
}

}  // namespace

DeviceProblem::DeviceProblem(DeviceLog log, const DeviceOptions& options)
    : log_(std::move(log)),
      options_(options),
      layout_(DeviceLayout::of(options.command, options.lag)),
      fixed_(options.fixed) {
  check_device_log(log_, options.motion, options.command);
  if (!(options.window > 0)) throw InputError("a window must last longer than 0 s");
  const DeviceSecondOpinion opinion = device_regression(log_, options.motion, options.command);
  double scale = 1;
  if (options.command == DeviceCommand::current) {
    const std::string mass = options.motion == DeviceMotionKind::linear ? "mass" : "inertia";
    scale = motor_scale(fixed_, mass.c_str(), opinion);
    if (!fixed_.contains("motor_constant") && !fixed_.contains(mass)) {
      fixed_["motor_constant"] = 1;
      warnings_.push_back("a current gives " + mass +
                          ", damping, coulomb and offset only over the motor constant, taken as "
                          "1: weigh it (--fix " +
                          mass + "=), or --fix motor_constant=");
    }
  }
  parameters_ = device_parameters(opinion, layout_, options.motion, scale, log_.period);
  begins_ = device_windows(opinion.velocities, options.window / log_.period);
  if (!opinion.reverses) {
    warnings_.emplace_back(
        "the axis moves one way only: dry friction and offset cannot be told apart");
  }
}

std::string DeviceProblem::unit() const {
  return options_.motion == DeviceMotionKind::linear ? "m" : "rad";
}

Problem::Stretch DeviceProblem::stretch(std::size_t index) const {
  const std::size_t first = begins_[index];
  const std::size_t count = begins_[index + 1] - first;
  // A parabola through the first 20 ms.
  constexpr double kLook = 0.02;
  const auto wanted = static_cast<std::size_t>(std::ceil(kLook / log_.period));
  const auto look = static_cast<Eigen::Index>(std::min(count, std::max<std::size_t>(wanted, 8)));
  Eigen::MatrixX3d powers(look, 3);
  Eigen::VectorXd positions(look);
  for (Eigen::Index i = 0; i < look; ++i) {
    const auto t = static_cast<double>(i);
    powers.row(i) << 1, t, t * t;
    positions[i] = log_.position[first + static_cast<std::size_t>(i)] - log_.position[first];
  }
  const Eigen::Vector3d fit = powers.householderQr().solve(positions);
  return {count, {log_.position[first] + fit[0], fit[1] / log_.period}};
}

std::vector<double> DeviceProblem::weights(std::size_t stretch) const {
  const auto first = log_.position.begin() + static_cast<std::ptrdiff_t>(begins_[stretch]);
  const auto last = log_.position.begin() + static_cast<std::ptrdiff_t>(begins_[stretch + 1]);
  std::vector<double> weights;
  for (auto run = first; run != last;) {
    const auto end = std::find_if(run, last, [run](double p) { return p != *run; });
    weights.insert(weights.end(), static_cast<std::size_t>(end - run),
                   1 / static_cast<double>(end - run));
    run = end;
  }
  return weights;
}

std::unique_ptr<ceres::CostFunction> DeviceProblem::cost(std::size_t stretch) const {
  return device_cost(log_, layout_, begins_[stretch], begins_[stretch + 1]);
}

}  // namespace hvp::fit
