#include "app/linux/dma_mappings.h"

#include <algorithm>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

namespace hvp::guest {

namespace {

std::string_view direction(DmaAccess access) {
  switch (access) {
    case DmaAccess::read:
      return "DMA_TO_DEVICE";
    case DmaAccess::write:
      return "DMA_FROM_DEVICE";
    case DmaAccess::both:
      break;
  }
  return "DMA_BIDIRECTIONAL";
}

bool allows(const DmaMapping& mapping, DmaAccess access) {
  return mapping.access == DmaAccess::both || mapping.access == access;
}

// Of a range that is not empty.
std::uint64_t last_address(std::uint64_t address, std::uint64_t bytes) {
  return address + (bytes - 1);
}

std::uint64_t last_address(const DmaMapping& mapping) {
  return last_address(mapping.address, mapping.bytes);
}

bool holds(const DmaMapping& mapping, std::uint64_t address) {
  return mapping.address <= address && address <= last_address(mapping);
}

std::uint64_t distance(const DmaMapping& mapping, std::uint64_t address, std::uint64_t last) {
  if (last_address(mapping) < address) return address - last_address(mapping);
  return mapping.address > last ? mapping.address - last : 0;
}

std::string at_time(Picoseconds time) {
  return fmt::format("at {}.{:03} ns", time / 1000, time % 1000);
}

}  // namespace

std::string describe(const DmaMapping& mapping) {
  return fmt::format("{} bytes at {:#x}, {}", mapping.bytes, mapping.address,
                     direction(mapping.access));
}

void DmaMappings::end(Place place, Picoseconds now) {
  past_.push_front({*place, now});
  if (past_.size() > kMostPast) past_.pop_back();
  mappings_.erase(place);
}

const DmaMapping* DmaMappings::overlapping(std::uint64_t address, std::uint64_t bytes) const {
  const std::uint64_t last = last_address(address, bytes);
  const auto found = std::ranges::find_if(
      mappings_, [=](const DmaMapping& m) { return distance(m, address, last) == 0; });
  return found == mappings_.end() ? nullptr : &*found;
}

// Of a range of which not all is mapped.
std::string DmaMappings::whereabouts(std::uint64_t address, std::uint64_t bytes) const {
  if (const DmaMapping* const part = overlapping(address, bytes)) {
    return fmt::format("the mapping there is of {}", describe(*part));
  }
  const auto past =
      std::ranges::find_if(past_, [=](const Past& p) { return holds(p.mapping, address); });
  if (past != past_.end()) {
    return fmt::format("the mapping there, {}, ended {}", describe(past->mapping),
                       at_time(past->ended));
  }
  if (mappings_.empty()) return "nothing is mapped";
  const std::uint64_t last = last_address(address, bytes);
  const auto away = [=](const DmaMapping& m) { return distance(m, address, last); };
  const auto nearest = std::ranges::min_element(mappings_, {}, away);
  return fmt::format("the nearest mapping is of {}", describe(*nearest));
}

std::string DmaMappings::unmap(const DmaMapping& mapping, Picoseconds now) {
  const auto same = std::ranges::find(mappings_, mapping);
  if (same != mappings_.end()) {
    end(same, now);
    return {};
  }
  const auto here = std::ranges::find(mappings_, mapping.address, &DmaMapping::address);
  if (here != mappings_.end()) {
    const std::string mapped = describe(*here);
    end(here, now);
    return fmt::format("unmaps {}, but mapped {}", describe(mapping), mapped);
  }
  const auto twice = std::ranges::find(past_, mapping, &Past::mapping);
  if (twice != past_.end() && overlapping(mapping.address, mapping.bytes) == nullptr) {
    return fmt::format("unmaps a second time {}; the first time was {}", describe(mapping),
                       at_time(twice->ended));
  }
  return fmt::format("unmaps {}, which is not mapped: {}", describe(mapping),
                     whereabouts(mapping.address, mapping.bytes));
}

std::string DmaMappings::sync(const DmaMapping& part) const {
  const auto around = [&](const DmaMapping& m) {
    return holds(m, part.address) && holds(m, last_address(part));
  };
  const auto right = [&](const DmaMapping& m) { return around(m) && allows(m, part.access); };
  if (std::ranges::any_of(mappings_, right)) return {};
  const auto found = std::ranges::find_if(mappings_, around);
  if (found != mappings_.end()) {
    return fmt::format("syncs {}, but mapped {}", describe(part), describe(*found));
  }
  return fmt::format("syncs {}, which is not all mapped: {}", describe(part),
                     whereabouts(part.address, part.bytes));
}

std::vector<DmaMapping> DmaMappings::clear(Picoseconds now) {
  std::vector<DmaMapping> left = mappings_;
  while (!mappings_.empty()) end(std::prev(mappings_.end()), now);
  return left;
}

std::string DmaMappings::refusal(std::uint64_t address, std::uint64_t bytes, bool write) const {
  if (bytes == 0) return {};
  const std::uint64_t last = last_address(address, bytes);
  if (last < address) return "it reaches beyond the last address";
  const DmaMapping* forbids = nullptr;
  for (std::uint64_t at = address;;) {
    // The mapping that reaches furthest from here, one of the right direction before others.
    const DmaMapping* furthest = nullptr;
    bool right = false;
    for (const DmaMapping& mapping : mappings_) {
      if (!holds(mapping, at)) continue;
      const bool allowed = allows(mapping, write ? DmaAccess::write : DmaAccess::read);
      if (right && !allowed) continue;
      if (furthest != nullptr && right == allowed &&
          last_address(mapping) <= last_address(*furthest)) {
        continue;
      }
      furthest = &mapping;
      right = allowed;
    }
    if (furthest == nullptr) {
      return "the driver has not mapped all of it: " + whereabouts(address, bytes);
    }
    if (!right && forbids == nullptr) forbids = furthest;
    if (last_address(*furthest) >= last) break;
    at = last_address(*furthest) + 1;
  }
  if (forbids == nullptr) return {};
  return fmt::format("the driver has mapped it for the other direction: {}", describe(*forbids));
}

}  // namespace hvp::guest
