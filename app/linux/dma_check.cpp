#include "app/linux/dma_check.h"

#include <spdlog/spdlog.h>

#include "vp/frame/frame_tag.h"

namespace hvp::guest {

namespace {

// A driver that is wrong in each job is not told of each one.
constexpr std::size_t kMostComplaints = 50;

}  // namespace

void DmaCheck::Counts::report(config::Figures& f) const {
  f.count("maps", maps, "ranges of memory that the driver mapped");
  f.count("refused", refused, "transfers of the board's outside them, or against their direction");
  f.count("misuses", misuses,
          "times the driver unmapped or synced what it had not mapped so, or left a mapping");
  f.count("left_mapped", left_mapped, "mappings that a driver left when it went");
}

DmaCheck::~DmaCheck() { memory_.refuse_if({}); }

void DmaCheck::accepted(bool tells) {
  tells_ = tells;
  if (tells) {
    memory_.refuse_if([this](std::uint64_t address, std::size_t bytes, bool write) {
      return why_not(address, bytes, write);
    });
    return;
  }
  memory_.refuse_if({});
  spdlog::warn(
      "--check dma: the kernel does not tell what its driver maps; expected one with "
      "driver/linux/kernel/patches/virt-pci-3-dma.patch");
}

std::string DmaCheck::why_not(std::uint64_t address, std::size_t bytes, bool write) {
  std::string why = mappings_.refusal(address, bytes, write);
  if (!why.empty()) ++counts_.refused;
  return why;
}

void DmaCheck::take(const vhost::Translation& message) {
  using Kind = vhost::Translation::Kind;
  const DmaMapping mapping{message.address, message.bytes, static_cast<DmaAccess>(message.access)};
  switch (message.kind) {
    case Kind::map:
      mappings_.map(mapping);
      ++counts_.maps;
      return;
    case Kind::unmap:
      complain(mappings_.unmap(mapping, vp::now_ps()));
      return;
    case Kind::sync_for_cpu:
    case Kind::sync_for_device:
      complain(mappings_.sync(mapping));
      return;
    case Kind::unbound:
      for (const DmaMapping& left : mappings_.clear(vp::now_ps())) {
        ++counts_.left_mapped;
        complain("has gone and left mapped " + describe(left));
      }
      return;
    case Kind::barrier:
      return;
  }
}

void DmaCheck::complain(const std::string& words) {
  if (words.empty()) return;
  ++counts_.misuses;
  if (said_.size() == kMostComplaints || !said_.insert(words).second) return;
  const vp::Picoseconds now = vp::now_ps();
  spdlog::warn("the driver {}, at {}.{:03} ns", words, now / 1000, now % 1000);
}

}  // namespace hvp::guest
