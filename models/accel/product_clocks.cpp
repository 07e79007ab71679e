#include "models/accel/product_clocks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "models/accel/bits.h"
#include "models/accel/partition.h"
#include "models/accel/symmetric.h"
#include "models/index.h"

namespace hvp::accel {

namespace {

// The bank that is asked most decides; fewer than three rows at once take the package again.
int served_clocks(const Architecture& a, const std::vector<int>& reads) {
  const int most = *std::ranges::max_element(reads);
  const int direct =
      std::max({1, ceil_div(most, a.direction_accesses()), ceil_div(3, a.rows_in_parallel)});
  if (a.matrix_storage == MatrixStorage::full) return direct;
  return symmetric_package_clocks(a, direct, most);
}

// All placements are looked at up to so many; beyond that, as many drawn ones.
constexpr std::uint64_t kPlacements = 1U << 14U;

// SplitMix64 (Steele et al. 2014).
std::uint64_t mixed(std::uint64_t number) {
  std::uint64_t z = (number + 1) * 0x9E3779B97F4A7C15U;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31U);
}

// Clocks that the multipliers hold the rows of a node.
class RowClocks {
 public:
  RowClocks(const Architecture& a, const Pattern& p)
      : a_(a), pattern_(p), reads_(at(3 * a.direction_banks)), first_block_(1, 0) {
    for (const int blocks : p.blocks_in_row) first_block_.push_back(first_block_.back() + blocks);
  }

  double of(std::size_t row) {
    double clocks = 0;
    const int columns = 3 * pattern_.blocks_in_row[row];
    const int packages = packages_of(a_, pattern_.blocks_in_row[row]);
    for (int k = 0; k < packages; ++k) {
      const int first = k * a_.package;
      const int used = std::clamp(columns - first, 0, a_.package);
      const bool placed = a_.direction_banks == 1 || pattern_.column.empty();
      clocks += placed ? mean(first % 3, used) : counted(3 * first_block_[row] + first, used);
    }
    return clocks;
  }

 private:
  double mean(int phase, int columns) {
    const auto [entry, fresh] = known_.try_emplace({phase, columns}, 0.0);
    if (fresh) entry->second = package_clocks(a_, phase, columns);
    return entry->second;
  }
  // The count from the known columns.
  int counted(int first, int columns) {
    std::ranges::fill(reads_, 0);
    for (int c = first; c < first + columns; ++c) {
      ++reads_[at(3 * (pattern_.column[at(c / 3)] % a_.direction_banks) + c % 3)];
    }
    return served_clocks(a_, reads_);
  }

  const Architecture& a_;
  const Pattern& pattern_;
  std::vector<int> reads_;
  std::vector<int> first_block_;
  std::map<std::pair<int, int>, double> known_;
};

}  // namespace

double package_clocks(const Architecture& a, int phase, int columns) {
  const int nodes = ceil_div(phase + columns, 3);
  const auto banks = static_cast<std::uint64_t>(a.direction_banks);
  std::uint64_t placements = 1;
  for (int node = 0; node < nodes && placements <= kPlacements; ++node) placements *= banks;
  const bool all = placements <= kPlacements;
  if (!all) placements = kPlacements;

  std::vector<int> reads(at(3 * a.direction_banks));
  double sum = 0;
  for (std::uint64_t placement = 0; placement < placements; ++placement) {
    std::ranges::fill(reads, 0);
    std::uint64_t digits = placement;
    std::uint64_t bank = 0;
    int node = -1;
    for (int c = phase; c < phase + columns; ++c) {
      if (c / 3 != node) {
        node = c / 3;
        bank = all ? digits % banks : mixed(64 * placement + at(node)) % banks;
        digits /= banks;
      }
      ++reads[3 * static_cast<std::size_t>(bank) + at(c % 3)];
    }
    sum += served_clocks(a, reads);
  }
  return sum / static_cast<double>(placements);
}

std::vector<double> clocks_of_rows(const Architecture& a, const Pattern& stored) {
  RowClocks rows(a, stored);
  std::vector<double> clocks;
  clocks.reserve(stored.blocks_in_row.size());
  for (std::size_t row = 0; row < stored.blocks_in_row.size(); ++row) {
    clocks.push_back(rows.of(row));
  }
  return clocks;
}

std::int64_t issue_clocks_of_fullest_partition(const Architecture& a, const Pattern& whole) {
  Pattern scratch;
  const Pattern& p = stored_pattern(a, whole, scratch);
  const std::vector<int> partition = deal_rows(a, p, a.partitions);
  const std::vector<double> clocks = clocks_of_rows(a, p);
  std::vector<double> sum(at(a.partitions), 0.0);
  for (std::size_t row = 0; row < partition.size(); ++row) sum[at(partition[row])] += clocks[row];
  return std::llround(*std::ranges::max_element(sum));
}

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
    bool passed_over = false;
    int lanes = lanes_;
    for (std::size_t i = 0; i < streams_.size() && lanes > 0; ++i) {
      const std::size_t who = (first + i) % streams_.size();
      Stream& stream = streams_[who];
      if (!stream.offers(clock)) continue;
      std::uint8_t& taken = bank_taken_[at(stream.bank[stream.taken])];
      if (taken != 0) {
        if (!passed_over) turn = who;
        passed_over = true;
        continue;
      }
      taken = 1;
      ++stream.taken;
      --lanes;
      if (!passed_over) turn = (who + 1) % streams_.size();
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
