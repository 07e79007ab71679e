#include "models/statistics/sum_of_times.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

namespace hvp::statistics {

namespace {

// The transforms' rounding, summed over a grid, is an order below it.
constexpr double kRounding = 1e-13;

}  // namespace

SumOfTimes::SumOfTimes(double cell_s, std::size_t cells)
    : cell_s_(cell_s), cells_(cells, 0), at_least_(cells, 0) {
  cells_.front() = 1;
  at_least_.front() = 1;
}

void SumOfTimes::add(const std::function<double(double)>& survival, int count) {
  if (count == 0) return;
  Cells one(cells_.size());
  double above = 1;
  for (std::size_t i = 0; i < one.size(); ++i) {
    const bool last = i + 1 == one.size();
    const double next = last ? 0 : survival(static_cast<double>(i + 1) * cell_s_);
    one[i] = above - next;
    above = next;
  }
  for (int i = 0; i < count; ++i) cells_ = convolved(cells_, one);
  parts_ += count;
  // From the far end on, so that small shares are summed before large ones.
  double sum = 0;
  for (std::size_t i = cells_.size(); i-- > 0;) at_least_[i] = sum += cells_[i];
}

SumOfTimes::Cells SumOfTimes::convolved(const Cells& a, const Cells& b) const {
  // Twice as long, so that nothing comes round to the begin.
  const auto padded = [](const Cells& cells) {
    Cells longer(cells);
    longer.resize(2 * cells.size(), 0);
    return longer;
  };
  Eigen::FFT<double> transform;
  std::vector<std::complex<double>> of_a;
  std::vector<std::complex<double>> of_b;
  transform.fwd(of_a, padded(a));
  transform.fwd(of_b, padded(b));
  for (std::size_t i = 0; i < of_a.size(); ++i) of_a[i] *= of_b[i];
  Cells sum;
  transform.inv(sum, of_a);
  for (std::size_t i = sum.size() - 1; i >= a.size(); --i) sum[a.size() - 1] += sum[i];
  sum.resize(a.size());
  return sum;
}

// The share of the sums of the cells' numbers from a place on, which lies between two.
double SumOfTimes::from(double cell) const {
  if (cell <= 0) return 1;
  const double below = std::floor(cell);
  const auto index = static_cast<std::size_t>(below);
  if (index + 1 >= at_least_.size()) return at_least_.back();
  return std::clamp(at_least_[index] + (cell - below) * (at_least_[index + 1] - at_least_[index]),
                    0.0, 1.0);
}

SumOfTimes::Share SumOfTimes::above(double seconds) const {
  if (seconds < 0) return {1, 1, 1};
  const double cell = seconds / cell_s_;
  if (parts_ == 0) return {};
  // The times lie somewhere in their cells: the sum is less than `parts` cells longer than that of
  // the cells' begins, and half as much in the mean.
  double low = from(std::floor(cell) + 1);
  double high = from(std::floor(cell - parts_) + 1);
  double middle = from(cell - 0.5 * (parts_ - 1));
  if (low < kRounding) low = 0;
  if (middle < kRounding) middle = 0;
  if (high < kRounding) high = kRounding;
  return {low, std::clamp(middle, low, high), high};
}

}  // namespace hvp::statistics
