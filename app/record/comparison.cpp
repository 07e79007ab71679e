#include "app/record/comparison.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace hvp::record {

namespace {

using Items = std::vector<Item>;

std::array<Items, kWhats> items_of(const Record& record) {
  std::array<Items, kWhats> all;
  Items& accesses = all.at(static_cast<std::size_t>(What::access));
  for (const Entry& entry : record.entries()) {
    switch (entry.kind) {
      case Kind::asked:
        accesses.push_back({&entry});
        break;
      case Kind::ended:
        accesses.at(entry.address).end = &entry;
        break;
      case Kind::message:
      case Kind::line:
      case Kind::missing:
        all.at(static_cast<std::size_t>(What::interrupt)).push_back({&entry});
        break;
      case Kind::memory_read:
      case Kind::memory_write:
        all.at(static_cast<std::size_t>(What::transfer)).push_back({&entry});
        break;
      case Kind::map:
      case Kind::unmap:
      case Kind::end:
      case Kind::fault:
        break;
    }
  }
  return all;
}

// Whether the host had more to do at that time is a matter of times.
std::uint8_t telling_flags(const Entry& entry) {
  if (entry.kind != Kind::asked) return entry.flags;
  return entry.flags & static_cast<std::uint8_t>(~kSettled);
}

bool same_entry(const Entry& a, const Entry& b) {
  return a.kind == b.kind && telling_flags(a) == telling_flags(b) && a.address == b.address &&
         a.bytes == b.bytes && std::ranges::equal(a.data, b.data);
}

bool same(const Item& a, const Item& b) {
  if (!same_entry(*a.entry, *b.entry) || (a.end == nullptr) != (b.end == nullptr)) return false;
  return a.end == nullptr || std::ranges::equal(a.end->data, b.end->data);
}

// The larger of the differences of an access' two times.
Picoseconds apart(const Item& a, const Item& b) {
  return std::max(std::abs(a.entry->time - b.entry->time), std::abs(a.time() - b.time()));
}

// Where the difference is in the first record: the byte of its entry that tells, and for an item
// that it has not, of the first entry behind that time.
std::size_t place(const Record& here, const Difference& difference) {
  if (difference.here) {
    const Item& item = *difference.here;
    const bool asked_alike = difference.there && same_entry(*item.entry, *difference.there->entry);
    return asked_alike && item.end != nullptr ? item.end->at : item.entry->at;
  }
  const Picoseconds time = difference.there->entry->time;
  const auto behind = std::ranges::find_if(
      here.entries(), [time](const Entry& entry) { return entry.time > time; });
  return behind == here.entries().end() ? std::numeric_limits<std::size_t>::max() : behind->at;
}

}  // namespace

Comparison compare(const Record& here, const Record& there) {
  const std::array<Items, kWhats> ours = items_of(here);
  const std::array<Items, kWhats> theirs = items_of(there);
  Comparison result;
  const auto note = [&here](std::optional<Difference>& first, const Difference& found) {
    if (!first || place(here, found) < place(here, *first)) first = found;
  };
  for (std::size_t w = 0; w < kWhats; ++w) {
    const Items& a = ours.at(w);
    const Items& b = theirs.at(w);
    Tally& tally = result.tallies.at(w);
    tally.here = static_cast<std::int64_t>(a.size());
    tally.there = static_cast<std::int64_t>(b.size());
    bool told = false;
    bool told_of_time = false;
    for (std::size_t n = 0; n < std::max(a.size(), b.size()); ++n) {
      Difference found;
      found.what = static_cast<What>(w);
      found.number = static_cast<std::int64_t>(n);
      if (n < a.size()) found.here = a[n];
      if (n < b.size()) found.there = b[n];
      if (!found.here || !found.there || !same(a[n], b[n])) {
        ++tally.differ;
        if (!told) note(result.first, found);
        told = true;
        continue;
      }
      const Picoseconds time = apart(a[n], b[n]);
      if (time == 0) continue;
      ++tally.other_times;
      tally.largest = std::max(tally.largest, time);
      if (!told_of_time) note(result.first_of_time, found);
      told_of_time = true;
    }
  }
  return result;
}

std::span<const std::uint8_t> data_of(const Item& item) {
  const bool reads = item.entry->kind == Kind::asked && !item.entry->has(kWrite);
  if (!reads) return item.entry->data;
  return item.end == nullptr ? std::span<const std::uint8_t>() : item.end->data;
}

std::optional<std::size_t> first_differing_word(const Item& here, const Item& there) {
  const auto a = data_of(here);
  const auto b = data_of(there);
  const auto [in_a, in_b] = std::ranges::mismatch(a, b);
  if (in_a == a.end() || in_b == b.end()) return std::nullopt;
  constexpr std::size_t kWordBytes = 4;
  return static_cast<std::size_t>(in_a - a.begin()) / kWordBytes * kWordBytes;
}

}  // namespace hvp::record
