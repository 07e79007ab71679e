#include "models/fit/qlv_twin.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "models/random/draws.h"

namespace hvp::fit {

IndentationLog press(const RampAndHold& motion, const QlvSettings& settings,
                     const std::vector<double>& values, double noise, std::int64_t seed) {
  const double seconds = motion.rest + motion.stroke / motion.rate + motion.hold;
  const auto samples = static_cast<std::size_t>(std::floor(seconds / motion.step)) + 1;
  PressedLog log{
      .time = {}, .depth = {}, .force = {}, .direction = 1, .step = motion.step, .warnings = {}};
  for (std::size_t i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) * motion.step;
    log.time.push_back(t);
    log.depth.push_back(std::clamp((t - motion.rest) * motion.rate, 0.0, motion.stroke));
  }
  std::vector<double> force = qlv_force(settings, log, values);
  const random::Draws draws(seed, "indentation");
  for (std::size_t i = 0; i < samples; ++i) {
    // Box & Muller.
    const random::Draws::Pair u = draws.uniform(static_cast<std::int64_t>(i));
    force[i] +=
        noise * std::sqrt(-2 * std::log(u.first)) * std::cos(2 * std::numbers::pi * u.second);
  }
  return {.time = log.time, .travel = log.depth, .force = force};
}

}  // namespace hvp::fit
