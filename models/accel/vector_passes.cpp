#include "models/accel/vector_passes.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "models/accel/bits.h"

namespace hvp::accel {

namespace {

class Groups {
 public:
  Groups(const Architecture& a, int nodes)
      : pipeline_(a.phase_clocks()),
        way_(std::max(1, a.phase_clocks() - a.adder_tree_clocks - 1)),
        ports_(a.direction_accesses()),
        each_write_(a.direction_write_accesses()),
        count_(ceil_div(nodes, a.nodes_per_clock)),
        words_(ceil_div(a.nodes_per_clock, a.direction_banks)),
        last_words_(ceil_div(nodes - (count_ - 1) * a.nodes_per_clock, a.direction_banks)) {}

  std::int64_t alone() const { return count_ + pipeline_; }

  // What a group leaves of its last clock is of no use to the next one.
  std::int64_t reading() const {
    return (count_ - 1) * ceil_div(words_, ports_) + ceil_div(last_words_, ports_) + pipeline_;
  }

  // Counted from the clock in which the first group is written: the last one is when the ports have
  // served all but a clock's accesses of those before it, and its own hold up the ranks behind.
  std::int64_t writing() const {
    const std::int64_t before = (count_ - 1) * words_ * each_write_;
    const std::int64_t last = std::max(count_, ceil_div(before, ports_));
    const std::int64_t served = ceil_div(before + last_words_ * each_write_, ports_);
    return pipeline_ + std::max(last, served - 1);
  }

  // The writes of the groups that come back keep further ones out, now and then: step by step.
  std::int64_t moving() const {
    if (words_ * (1 + each_write_) <= ports_) return alone();
    std::vector<std::int64_t> entered;  // the lanes' steps at which groups did
    entered.reserve(static_cast<std::size_t>(count_));
    std::size_t written = 0;
    std::int64_t reads_left = 0;
    std::int64_t writes_left = 0;
    std::int64_t steps = 0;
    std::int64_t clock = 0;
    while (left(entered) > 0 || steps < entered.back() + pipeline_ - 1) {
      ++clock;
      if (writes_left > ports_) {
        writes_left -= ports_;
        continue;
      }
      std::int64_t accesses = ports_ - writes_left;
      writes_left = 0;
      ++steps;
      if (written < entered.size() && entered[written] + way_ == steps) {
        writes_left = words(++written) * each_write_;
        const std::int64_t now = std::min(accesses, writes_left);
        writes_left -= now;
        accesses -= now;
      }
      if (left(entered) == 0) continue;
      const std::int64_t needed = words(static_cast<std::int64_t>(entered.size()) + 1);
      if (reads_left == 0) reads_left = needed;
      if (needed <= ports_ && accesses < needed) continue;
      reads_left -= std::min(accesses, reads_left);
      if (reads_left == 0) entered.push_back(steps);
    }
    return clock + 1;
  }

 private:
  // Of the fullest bank, by the group's number from 1.
  std::int64_t words(std::int64_t group) const { return group < count_ ? words_ : last_words_; }
  std::int64_t words(std::size_t group) const { return words(static_cast<std::int64_t>(group)); }
  std::int64_t left(const std::vector<std::int64_t>& entered) const {
    return count_ - static_cast<std::int64_t>(entered.size());
  }

  std::int64_t pipeline_;
  std::int64_t way_;  // from where it enters to its write
  std::int64_t ports_;
  std::int64_t each_write_;
  std::int64_t count_;
  std::int64_t words_;
  std::int64_t last_words_;
};

}  // namespace

VectorPasses vector_passes(const Architecture& a, int nodes) {
  const Groups groups(a, nodes);
  if (nodes == 0) return {groups.alone(), groups.alone(), groups.alone(), groups.alone()};
  return {groups.alone(), groups.reading(), groups.writing(), groups.moving()};
}

}  // namespace hvp::accel
