#include "models/accel/row_schedule.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

#include "models/accel/bank_conflicts.h"
#include "models/accel/partition.h"
#include "models/index.h"

namespace hvp::accel {

namespace {

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

// A partition's rows, and how far they are.
struct Stream {
  std::vector<int> bank;             // of A·d, of each row
  std::vector<std::int64_t> clocks;  // that the multipliers hold its packages
  std::vector<std::int64_t> queued;  // from which clock it can be taken; as far as issued
  std::size_t taken = 0;
  std::int64_t served = 0;  // when the next row's packages have passed the multipliers

  bool left() const { return taken < clocks.size(); }
  bool offers(std::int64_t clock) const { return taken < queued.size() && queued[taken] <= clock; }
  bool may_issue(std::size_t room) const {
    return queued.size() < clocks.size() && queued.size() - taken < room;
  }
  void restart() {
    queued.clear();
    taken = 0;
    served = clocks.empty() ? 0 : clocks.front();
  }
  void issue(std::int64_t clock, std::int64_t way) {
    queued.push_back(clock + way);
    if (queued.size() < clocks.size()) served = clock + clocks[queued.size()];
  }
  // The first clock after this one at which it can do anything of itself.
  std::int64_t next(std::int64_t clock, std::size_t room) const {
    std::int64_t soonest = kNever;
    if (may_issue(room)) soonest = served;
    if (taken < queued.size()) soonest = std::min(soonest, queued[taken]);
    return soonest == kNever ? kNever : std::max(soonest, clock + 1);
  }
};

class Machine {
 public:
  Machine(const Architecture& a, const Pattern& p)
      : lanes_(a.nodes_per_clock),
        room_(at(a.result_queue)),
        way_(a.memory_read_clocks + a.multiplier_clocks + a.adder_tree_clocks),
        streams_(at(a.partitions)),
        bank_taken_(at(lanes_)) {
    const std::vector<int> partition = deal_rows(a, p, a.partitions);
    const std::vector<double> clocks = clocks_of_rows(a, p);
    std::vector<double> sum(streams_.size(), 0);
    for (std::size_t row = 0; row < partition.size(); ++row) {
      Stream& stream = streams_[at(partition[row])];
      double& until = sum[at(partition[row])];
      // Means of packages whose columns are not known add up to whole clocks.
      const std::int64_t before = std::llround(until);
      until += clocks[row];
      stream.clocks.push_back(std::llround(until) - before);
      stream.bank.push_back(static_cast<int>(row) % lanes_);
      stream.queued.reserve(stream.clocks.size());
    }
    issued_ = std::llround(*std::ranges::max_element(sum));
  }

  std::int64_t issued() const { return issued_; }
  std::size_t turns() const { return streams_.size(); }

  // Clocks until the last row is taken, by who is first in turn; who that is next.
  std::int64_t product(std::size_t& turn) {
    for (Stream& stream : streams_) stream.restart();
    std::int64_t clock = 0;
    while (std::ranges::any_of(streams_, &Stream::left)) {
      std::int64_t next = kNever;
      for (const Stream& s : streams_) next = std::min(next, s.next(clock, room_));
      clock = next;
      for (Stream& s : streams_) {
        if (s.may_issue(room_) && s.served <= clock) s.issue(clock, way_);
      }
      take(clock, turn);
    }
    return clock - way_;
  }

 private:
  void take(std::int64_t clock, std::size_t& turn) {
    std::ranges::fill(bank_taken_, std::uint8_t{0});
    const std::size_t first = turn;
    int lanes = lanes_;
    for (std::size_t i = 0; i < streams_.size() && lanes > 0; ++i) {
      const std::size_t who = (first + i) % streams_.size();
      Stream& stream = streams_[who];
      if (!stream.offers(clock)) continue;
      std::uint8_t& taken = bank_taken_[at(stream.bank[stream.taken])];
      if (taken != 0) continue;
      taken = 1;
      ++stream.taken;
      --lanes;
      turn = (who + 1) % streams_.size();
    }
  }

  int lanes_;
  std::size_t room_;
  std::int64_t way_;
  std::vector<Stream> streams_;
  std::vector<std::uint8_t> bank_taken_;
  std::int64_t issued_ = 0;
};

}  // namespace

RowSchedule row_schedule(const Architecture& a, const Pattern& p) {
  if (p.nodes() == 0) return {};
  Machine machine(a, p);
  constexpr std::size_t kUnseen = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> seen(machine.turns(), kUnseen);
  std::vector<std::int64_t> clocks;
  std::size_t turn = 0;
  while (seen[turn] == kUnseen) {
    seen[turn] = clocks.size();
    clocks.push_back(machine.product(turn));
  }
  const auto repeated = clocks.begin() + static_cast<std::ptrdiff_t>(seen[turn]);
  const auto count = static_cast<std::int64_t>(clocks.end() - repeated);
  const std::int64_t sum = std::accumulate(repeated, clocks.end(), std::int64_t{0});
  return {machine.issued(), (sum + count / 2) / count};
}

}  // namespace hvp::accel
