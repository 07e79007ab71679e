#include "models/accel/bank_conflicts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
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
  // Of the columns as they are.
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

}  // namespace hvp::accel
