#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace hvp::statistics {

// The distribution of a sum of independent times, none below zero, by convolution on a grid of
// equal cells. A time is taken to lie in the cell that has it; how far that may move a share is
// bounded, and the bounds are part of every answer. So is the rounding of the transforms: no share
// below 1e-13 is told from none.
class SumOfTimes {
 public:
  // The sum of no time at all, which is zero. `cells` is a power of two, `cell_s` the width of one
  // in s; what is longer than the grid is in its last cell.
  SumOfTimes(double cell_s, std::size_t cells);

  // Adds `count` more times of one kind. `survival` is the share of them that are longer than a
  // time in s.
  void add(const std::function<double(double)>& survival, int count);

  double cell_s() const { return cell_s_; }

  // A share with its bounds; low <= share <= high, each between 0 and 1.
  struct Share {
    double low = 0;
    double share = 0;
    double high = 0;
  };
  // The share of the sums that are longer than `seconds`, which lies before the last cell. 1 for
  // less than nothing.
  Share above(double seconds) const;

 private:
  using Cells = std::vector<double>;

  Cells convolved(const Cells& a, const Cells& b) const;
  double from(double cell) const;

  double cell_s_;
  Cells cells_;     // the shares of the sums of the cells' numbers
  Cells at_least_;  // the share of the sums from this cell on
  int parts_ = 0;   // times of which the sum is
};

}  // namespace hvp::statistics
