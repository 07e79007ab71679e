#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>

#include <ceres/jet.h>

#include "models/fit/device_motion.h"
#include "models/fit/device_problem.h"

namespace hvp::fit {
namespace {

// The derivatives are by all parameters and by the initial velocity; the initial position only
// adds.
constexpr int kDeviceParameters = 7;
constexpr int kVelocity = kDeviceParameters;
using DeviceJet = ceres::Jet<double, kDeviceParameters + 1>;

// A delay of whole samples and of a part of one. The part begins at 0 or ends at a whole sample:
// both give the same motion, with the same derivatives.
template <typename T>
struct Delay {
  std::ptrdiff_t whole;
  T part;  // s

  Delay(const T& delay, double period)
      : whole(static_cast<std::ptrdiff_t>(std::floor(plain(delay) / period))),
        part(delay - static_cast<double>(whole) * period) {}
};

// The command of sample `at`; before the log it is the first one.
double held(const DeviceLog& log, std::ptrdiff_t at) {
  return log.command[static_cast<std::size_t>(std::max<std::ptrdiff_t>(at, 0))];
}

// The part of the commands that has passed the amplifier's lag at a sample. Older commands than
// e⁻³⁷ of the lag are below rounding and left out.
template <typename T>
T arrived(const DeviceLog& log, std::size_t sample, const T& lag, const T& delay_s) {
  const double forgets = 37 / (plain(lag) * log.period);
  const auto at = static_cast<std::ptrdiff_t>(sample);
  const std::ptrdiff_t first =
      forgets < static_cast<double>(at) ? at - static_cast<std::ptrdiff_t>(std::ceil(forgets)) : 0;
  const Delay<T> delay(delay_s, log.period);
  using std::exp;
  const T over_all = exp(-lag * log.period);
  const T over_rest = exp(-lag * (log.period - delay.part));
  T g(held(log, first - delay.whole - 1));
  for (std::ptrdiff_t i = first; i < at; ++i) {
    const double before = held(log, i - delay.whole - 1);
    const double after = held(log, i - delay.whole);
    g = (g - before) * over_all;
    if (before != after) g += over_rest * (before - after);
    g += after;
  }
  return g;
}

double arrived_with(const DeviceLog& log, std::size_t sample, double lag, double delay) {
  return arrived(log, sample, lag, delay);
}

// The same with its derivatives. Only two of them are carried through its many steps.
DeviceJet arrived_with(const DeviceLog& log, std::size_t sample, const DeviceJet& lag,
                       const DeviceJet& delay) {
  using Two = ceres::Jet<double, 2>;
  const Two g = arrived(log, sample, Two(lag.a, 0), Two(delay.a, 1));
  DeviceJet all(g.a);
  all.v = g.v[0] * lag.v + g.v[1] * delay.v;
  return all;
}

class DeviceCost final : public ceres::CostFunction {
 public:
  DeviceCost(const DeviceLog& log, const DeviceLayout& layout, std::size_t first, std::size_t last)
      : log_(log), layout_(layout), first_(first), last_(last) {
    set_num_residuals(static_cast<int>(last - first));
    *mutable_parameter_block_sizes() = {static_cast<std::int32_t>(layout.count), 2};
  }

  bool Evaluate(const double* const* blocks, double* residuals, double** jacobians) const override {
    const double begins = blocks[1][0];
    if (jacobians == nullptr) {
      return follow(blocks[0], blocks[1][1], [&](std::size_t i, double x) {
        residuals[i] = log_.position[first_ + i] - (begins + x);
      });
    }
    DeviceJet values[kDeviceParameters];
    for (std::size_t i = 0; i < layout_.count; ++i) {
      values[i] = DeviceJet(blocks[0][i], static_cast<int>(i));
    }
    const DeviceJet velocity(blocks[1][1], kVelocity);
    return follow(values, velocity, [&](std::size_t i, const DeviceJet& x) {
      residuals[i] = log_.position[first_ + i] - (begins + x.a);
      if (jacobians[0] != nullptr) {
        double* const row = jacobians[0] + i * layout_.count;
        for (std::size_t p = 0; p < layout_.count; ++p) row[p] = -x.v[static_cast<int>(p)];
      }
      if (jacobians[1] != nullptr) {
        jacobians[1][2 * i] = -1;
        jacobians[1][2 * i + 1] = -x.v[kVelocity];
      }
    });
  }

 private:
  template <typename T>
  DeviceAxis<T> axis(const T* values) const {
    const T lightness = 1.0 / values[layout_.mass];
    DeviceAxis<T> axis;
    axis.gain = lightness;
    if (layout_.motor_constant != DeviceLayout::kNone) {
      axis.gain = values[layout_.motor_constant] * lightness;
    }
    axis.damping = values[layout_.damping] * lightness;
    axis.coulomb = values[layout_.coulomb] * lightness;
    axis.offset = values[layout_.offset] * lightness;
    axis.lags = layout_.bandwidth != DeviceLayout::kNone;
    if (axis.lags) axis.lag = values[layout_.bandwidth] * (2 * std::numbers::pi);
    return axis;
  }

  // Passes the axis' position at each sample on; false where there is none for these values.
  template <typename T, typename See>
  bool follow(const T* values, const T& velocity, const See& see) const {
    for (std::size_t i = 0; i < layout_.count; ++i) {
      if (!std::isfinite(plain(values[i]))) return false;
    }
    const DeviceAxis<T> axis = this->axis(values);
    const T& delay_s = values[layout_.delay];
    if (!(plain(values[layout_.mass]) > 0) || plain(axis.damping) < 0 || plain(axis.coulomb) < 0 ||
        plain(delay_s) < 0 || (axis.lags && !(plain(axis.lag) > 0))) {
      return false;
    }
    const Delay<T> delay(delay_s, log_.period);
    const DeviceMotion<T> motion(axis);
    const T rest = log_.period - delay.part;
    const DeviceStep<T> over_all = axis.step(T(log_.period));
    const DeviceStep<T> over_part = axis.step(delay.part);
    const DeviceStep<T> over_rest = axis.step(rest);

    DeviceState<T> state;
    state.v = velocity;
    state.slips = plain(velocity) > 0 ? 1 : plain(velocity) < 0 ? -1 : 0;
    if (axis.lags) state.command = arrived_with(log_, first_, axis.lag, delay_s);
    see(0, state.x);
    for (std::size_t i = first_; i + 1 < last_; ++i) {
      const auto at = static_cast<std::ptrdiff_t>(i) - delay.whole;
      const double before = held(log_, at - 1);
      const double after = held(log_, at);
      if (before == after) {
        motion.advance(after, T(log_.period), over_all, state);
      } else {
        motion.advance(before, delay.part, over_part, state);
        motion.advance(after, rest, over_rest, state);
      }
      if (!std::isfinite(plain(state.x))) return false;
      see(i + 1 - first_, state.x);
    }
    return true;
  }

  const DeviceLog& log_;
  DeviceLayout layout_;
  std::size_t first_;
  std::size_t last_;
};

}  // namespace

DeviceLayout DeviceLayout::of(DeviceCommand command, bool lag) {
  DeviceLayout layout;
  std::size_t next = 4;
  if (command == DeviceCommand::current) layout.motor_constant = next++;
  if (lag) layout.bandwidth = next++;
  layout.delay = next++;
  layout.count = next;
  return layout;
}

std::unique_ptr<ceres::CostFunction> device_cost(const DeviceLog& log, const DeviceLayout& layout,
                                                 std::size_t first, std::size_t last) {
  return std::make_unique<DeviceCost>(log, layout, first, last);
}

}  // namespace hvp::fit
