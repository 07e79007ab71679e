#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "models/time/picoseconds.h"

namespace hvp::guest {

// What a bus master may do in a mapping; as VHOST_ACCESS_RO, WO and RW.
enum class DmaAccess : std::uint8_t { read = 1, write = 2, both = 3 };

// A range of bus addresses, neither empty nor beyond the last address.
struct DmaMapping {
  std::uint64_t address = 0;
  std::uint64_t bytes = 1;
  DmaAccess access = DmaAccess::both;
  bool operator==(const DmaMapping&) const = default;
};

// What a guest's driver has mapped for its function, to the byte: the table of an IOMMU, and the
// rules of the kernel's DMA API (Documentation/core-api/dma-api.rst). Mappings may overlap: Linux
// maps as often as it is asked.
//
// What breaks a rule is told in words, which go on "the driver …"; no words: all is well.
class DmaMappings {
 public:
  // The mappings that ended last are known, so that an address of one of them can be named.
  static constexpr std::size_t kMostPast = 256;

  void map(const DmaMapping& mapping) { mappings_.push_back(mapping); }
  // Removes the mapping with this address, whatever else is wrong. A part that does not begin where
  // its mapping does is not removed.
  std::string unmap(const DmaMapping& mapping, Picoseconds now);
  // A part of a mapping changes hands between the processor and the function.
  std::string sync(const DmaMapping& part) const;
  // The driver has gone. Returns what it left mapped, which ends.
  std::vector<DmaMapping> clear(Picoseconds now);

  // Why the function may not make this transfer; no words: it may. Transfers may cross from one
  // mapping to the next.
  std::string refusal(std::uint64_t address, std::uint64_t bytes, bool write) const;

 private:
  struct Past {
    DmaMapping mapping;
    Picoseconds ended = 0;
  };
  using Place = std::vector<DmaMapping>::iterator;

  void end(Place place, Picoseconds now);
  const DmaMapping* overlapping(std::uint64_t address, std::uint64_t bytes) const;
  std::string whereabouts(std::uint64_t address, std::uint64_t bytes) const;

  std::vector<DmaMapping> mappings_;
  std::deque<Past> past_;  // the latest first
};

// Such as "8192 bytes at 0x2f60000, DMA_TO_DEVICE".
std::string describe(const DmaMapping& mapping);

}  // namespace hvp::guest
