#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "app/record/record.h"

// What two records of accesses differ in: a record and its replay, or two records of two drivers.
// Without SystemC.
namespace hvp::record {

// What is compared. Each has an order of its own, as how they interleave is a matter of times:
// the n-th access of one with the n-th of the other, and so on.
enum class What : std::uint8_t { access, interrupt, transfer };
inline constexpr std::size_t kWhats = 3;

// An access with its end, an interrupt, or what the board has moved.
struct Item {
  const Entry* entry = nullptr;
  const Entry* end = nullptr;  // of an access; null: it has none

  Picoseconds time() const { return end == nullptr ? entry->time : end->time; }
};

struct Tally {
  std::int64_t here = 0;   // in the first record
  std::int64_t there = 0;  // in the second
  std::int64_t differ = 0;
  // Of those that are alike.
  std::int64_t other_times = 0;
  Picoseconds largest = 0;  // the largest of these differences

  std::int64_t compared() const { return here < there ? here : there; }
};

struct Difference {
  What what = What::access;
  std::int64_t number = 0;  // of its kind, from 0
  // At least one is there.
  std::optional<Item> here;
  std::optional<Item> there;
};

struct Comparison {
  std::array<Tally, kWhats> tallies;
  // In the order of the first record, or of times where that has no such item.
  std::optional<Difference> first;
  std::optional<Difference> first_of_time;

  const Tally& of(What what) const { return tallies.at(static_cast<std::size_t>(what)); }
  bool alike() const { return !first; }
};

// The entries of the result are those of the records, which have to outlive it.
Comparison compare(const Record& here, const Record& there);

// The data that tell two items apart: what an access has written or read, what was moved. Empty
// where they are alike, or of different lengths.
std::span<const std::uint8_t> data_of(const Item& item);
// The place of the first 32-bit word in which the data differ, in bytes; none where there is no
// such word in both.
std::optional<std::size_t> first_differing_word(const Item& here, const Item& there);

}  // namespace hvp::record
