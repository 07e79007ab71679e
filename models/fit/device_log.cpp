#include "models/fit/device_log.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "models/config/input_error.h"
#include "models/fit/log_columns.h"

namespace hvp::fit {

namespace {

double largest_step(const std::vector<double>& column) {
  double largest = 0;
  for (std::size_t i = 1; i < column.size(); ++i) {
    largest = std::max(largest, std::abs(column[i] - column[i - 1]));
  }
  return largest;
}

}  // namespace

std::string device_command_name(DeviceMotionKind motion, DeviceCommand command) {
  if (command == DeviceCommand::current) return "current (A)";
  return motion == DeviceMotionKind::linear ? "force (N)" : "torque (N·m)";
}

std::string device_position_name(DeviceMotionKind motion) {
  return motion == DeviceMotionKind::linear ? "position (m)" : "angle (rad)";
}

void check_device_log(const DeviceLog& log, DeviceMotionKind motion, DeviceCommand command) {
  const std::string told = device_command_name(motion, command);
  const std::string seen = device_position_name(motion);
  check_columns(log.period, {{told, log.command, "nothing tells how the axis follows it"},
                             {seen, log.position, "a log of an axis that moves is needed"}});
  // A command may jump; what has a mass cannot cross much of its range within a sample.
  constexpr double kJump = 0.25;
  if (largest_step(log.position) > kJump * range_of(log.position) &&
      largest_step(log.command) < kJump * range_of(log.command)) {
    throw InputError("the " + seen + " jumps and the " + told +
                     " does not: are their columns swapped?");
  }
}

namespace {

constexpr double kFewestWindowSamples = 10;
constexpr double kSlow = 0.3;  // of the velocity's rms

// The fastest of the samples [first, last); where all are slow, the first one behind them that is
// not; else `first`.
std::size_t fast_sample(const std::vector<double>& velocities, double slow, std::size_t first,
                        std::size_t last) {
  const auto begin = velocities.begin();
  const auto smaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const auto fastest = std::max_element(begin + static_cast<std::ptrdiff_t>(first),
                                        begin + static_cast<std::ptrdiff_t>(last), smaller);
  if (std::abs(*fastest) >= slow) return static_cast<std::size_t>(fastest - begin);
  for (std::size_t i = last; i < velocities.size(); ++i) {
    if (std::abs(velocities[i]) >= slow) return i;
  }
  return velocities.size();
}

}  // namespace

double rms(const std::vector<double>& x) {
  double sum = 0;
  for (const double value : x) sum += value * value;
  return std::sqrt(sum / static_cast<double>(x.size()));
}

std::vector<std::size_t> device_windows(const std::vector<double>& velocities, double length) {
  const std::size_t samples = velocities.size();
  const auto total = static_cast<double>(samples);
  const auto window =
      static_cast<std::size_t>(std::clamp(std::round(length), kFewestWindowSamples, total));
  const std::size_t around = window / 4;
  const double slow = kSlow * rms(velocities);

  std::vector<std::size_t> begins{
      fast_sample(velocities, slow, 0, std::clamp<std::size_t>(samples / 10, 1, window / 2))};
  // At least half a window is left behind the last one.
  for (;;) {
    const std::size_t first = begins.back() + window - around;
    if (first + around + window / 2 >= samples) break;
    const std::size_t next = fast_sample(velocities, slow, first, first + 2 * around + 1);
    if (next + window / 2 >= samples) break;
    begins.push_back(next);
  }
  begins.push_back(samples);
  return begins;
}

namespace {

using Column = std::vector<double>;

// Derives x″, x′, sign x′, and where the axis moves, from positions.
struct Motion {
  Column acceleration, velocity, sign;
  std::vector<std::size_t> rows;  // samples to use
  bool reverses = false;
};

Motion motion_of(const Column& position, double period, double cutoff_times_period) {
  const std::size_t n = position.size();
  Motion motion{Column(n), Column(n), Column(n), {}, false};
  // Positions are relative to the first: an encoder's origin does not matter.
  Column from_start(n);
  for (std::size_t i = 0; i < n; ++i) from_start[i] = position[i] - position[0];
  const Column x = low_passed(from_start, cutoff_times_period);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    motion.velocity[i] = (x[i + 1] - x[i - 1]) / (2 * period);
    motion.acceleration[i] = (x[i + 1] - 2 * x[i] + x[i - 1]) / (period * period);
  }
  // Near standstill the friction is not known.
  constexpr double kStands = 0.05;  // of the velocity's rms
  const double stands = kStands * rms(motion.velocity);
  const auto edge = std::min(n / 8, static_cast<std::size_t>(1 / cutoff_times_period));
  bool forth = false;
  bool back = false;
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double v = motion.velocity[i];
    motion.sign[i] = std::abs(v) <= stands ? 0 : std::copysign(1.0, v);
    if (motion.sign[i] == 0 || i < edge + kMostDelaySamples || i + edge + 1 >= n) continue;
    motion.rows.push_back(i);
    (v > 0 ? forth : back) = true;
  }
  motion.sign = low_passed(motion.sign, cutoff_times_period);
  motion.reverses = forth && back;
  return motion;
}

struct Least {
  Eigen::Vector4d values = Eigen::Vector4d::Zero();  // of x″, x′, sign x′, 1
  double residual = 0;                               // sum of squares over the command's
};

// [x″, x′, sign x′, 1]·values = command, `late` samples before.
class Regression {
 public:
  explicit Regression(const Motion& motion) : motion_(motion) {
    Eigen::Matrix4d gram = Eigen::Matrix4d::Zero();
    for (const std::size_t i : motion.rows) gram += row(i) * row(i).transpose();
    scale_ = gram.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
    gram = scale_.asDiagonal() * gram * scale_.asDiagonal();
    solver_.setThreshold(1e-10);
    solver_.compute(gram);
  }

  Least at(const Column& command, std::size_t late) const {
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    for (const std::size_t i : motion_.rows) right += row(i) * command[i - late];
    Least least;
    least.values = scale_.asDiagonal() * solver_.solve(scale_.asDiagonal() * right);
    double squares = 0;
    for (const std::size_t i : motion_.rows) {
      const double c = command[i - late];
      squares += c * c;
      least.residual += std::pow(c - row(i).dot(least.values), 2);
    }
    if (squares > 0) least.residual /= squares;
    return least;
  }

 private:
  Eigen::Vector4d row(std::size_t i) const {
    return {motion_.acceleration[i], motion_.velocity[i], motion_.reverses ? motion_.sign[i] : 0,
            1};
  }

  const Motion& motion_;
  Eigen::Vector4d scale_ = Eigen::Vector4d::Ones();
  Eigen::FullPivLU<Eigen::Matrix4d> solver_;
};

// The minimum of the parabola through three neighbouring residuals, in samples; at an end of the
// range the end.
double between(const std::vector<double>& residuals, std::size_t best) {
  const auto at = static_cast<double>(best);
  if (best == 0 || best + 1 == residuals.size()) return at;
  const double before = residuals[best - 1], here = residuals[best], after = residuals[best + 1];
  const double bend = before - 2 * here + after;
  return bend > 0 ? at + 0.5 * (before - after) / bend : at;
}

DeviceSecondOpinion regress(const DeviceLog& log) {
  constexpr double kHighest = 40;  // Hz: a device's motion by hand or motor lies below
  constexpr double kOfSampling = 0.1;
  const double cutoff = std::min(kHighest * log.period, kOfSampling);
  const Motion motion = motion_of(log.position, log.period, cutoff);
  const Column command = low_passed(log.command, cutoff);

  DeviceSecondOpinion opinion;
  opinion.reverses = motion.reverses;
  opinion.velocity = rms(motion.velocity);
  opinion.acceleration = rms(motion.acceleration);
  opinion.velocities = motion.velocity;
  double mean = 0;
  for (const double c : log.command) mean += c / static_cast<double>(log.command.size());
  Column about = log.command;
  for (double& c : about) {
    opinion.command_most = std::max(opinion.command_most, std::abs(c));
    c -= mean;
  }
  opinion.command = rms(about);
  if (motion.rows.size() < 8) return opinion;

  const Regression regression(motion);
  std::vector<double> residuals;
  std::size_t best = 0;
  Least least;
  for (std::size_t late = 0; late <= kMostDelaySamples; ++late) {
    const Least tried = regression.at(command, late);
    residuals.push_back(tried.residual);
    if (late > 0 && tried.residual >= residuals[best]) continue;
    best = late;
    least = tried;
  }
  opinion.mass = least.values[0];
  opinion.damping = least.values[1];
  opinion.coulomb = least.values[2];
  opinion.offset = -least.values[3];
  opinion.delay = between(residuals, best) * log.period;
  opinion.explained = 1 - least.residual;
  return opinion;
}

}  // namespace

DeviceSecondOpinion device_regression(const DeviceLog& log, DeviceMotionKind motion,
                                      DeviceCommand command) {
  DeviceSecondOpinion opinion = regress(log);
  if (opinion.explained == 0) {
    throw InputError("the " + device_position_name(motion) +
                     " hardly moves: too few samples are left to learn from");
  }
  if (opinion.mass <= 0) {
    throw InputError("the axis accelerates against the " + device_command_name(motion, command) +
                     " (a regression gives a negative mass): are the columns swapped, or is a "
                     "sign turned round?");
  }
  if (opinion.damping >= 0 && opinion.coulomb >= 0) return opinion;
  // Command and position of a sinusoid, swapped, make a positive mass and a negative damping.
  const DeviceSecondOpinion swapped = regress({log.period, log.position, log.command});
  if (swapped.mass > 0 && swapped.damping >= 0 && swapped.coulomb >= 0 &&
      swapped.explained > opinion.explained) {
    throw InputError("the " + device_position_name(motion) + " explains the " +
                     device_command_name(motion, command) +
                     " worse than the other way round: are the columns swapped?");
  }
  return opinion;
}

}  // namespace hvp::fit
