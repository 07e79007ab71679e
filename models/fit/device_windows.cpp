#include "models/fit/device_windows.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace hvp::fit {
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
  // What is left behind the last one is half a window at least.
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

}  // namespace hvp::fit
