#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "app/linux/dma_mappings.h"
#include "app/linux/vhost_user.h"
#include "models/config/figures.h"
#include "vp/bus/host_memory.h"

namespace hvp::guest {

// The IOMMU between the board and the guest's memory, from which it hears what its driver maps. A
// transfer to or from anywhere else is refused, as one to an address without memory is, with a
// warning that says why; what the driver does against the rules of the DMA API is a warning.
class DmaCheck {
 public:
  struct Counts {
    std::int64_t maps = 0;
    std::int64_t refused = 0;  // transfers of the board's
    std::int64_t misuses = 0;  // by the driver
    std::int64_t left_mapped = 0;
    void report(config::Figures& f) const;
  };

  // Keeps a reference. Nothing is refused before the guest has said that it tells what it maps.
  explicit DmaCheck(vp::HostMemory& memory) : memory_(memory) {}
  ~DmaCheck();
  DmaCheck(const DmaCheck&) = delete;
  DmaCheck& operator=(const DmaCheck&) = delete;

  // The guest will tell of its mappings, or will not.
  void accepted(bool tells);
  void take(const vhost::Translation& message);
  // None if the guest does not tell.
  std::optional<Counts> counts() const { return tells_ ? std::optional(counts_) : std::nullopt; }

 private:
  std::string why_not(std::uint64_t address, std::size_t bytes, bool write);
  void complain(const std::string& words);

  vp::HostMemory& memory_;
  DmaMappings mappings_;
  std::set<std::string> said_;
  bool tells_ = false;
  Counts counts_;
};

}  // namespace hvp::guest
