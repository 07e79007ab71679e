#include "models/fit/device_problem.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "models/config/input_error.h"
#include "models/fit/device_parameters.h"
#include "models/fit/device_windows.h"

namespace hvp::fit {
namespace {

// Of a log of currents: the constant that starts assume.
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
  opinion_ = device_regression(log_, options.motion, options.command);
  double scale = 1;
  if (options.command == DeviceCommand::current) {
    const std::string mass = options.motion == DeviceMotionKind::linear ? "mass" : "inertia";
    scale = motor_scale(fixed_, mass.c_str(), opinion_);
    if (!fixed_.contains("motor_constant") && !fixed_.contains(mass)) {
      fixed_["motor_constant"] = 1;
      warnings_.push_back("a current gives " + mass +
                          ", damping, coulomb and offset only over the motor constant, taken as "
                          "1: weigh it (--fix " +
                          mass + "=), or --fix motor_constant=");
    }
  }
  parameters_ = device_parameters(opinion_, layout_, options.motion, scale, log_.period);
  begins_ = device_windows(opinion_.velocities, options.window / log_.period);
  if (!opinion_.reverses) {
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
