#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "tests/vp/board_rig.h"

namespace hvp::test {

// A board that is a master on a PCI bus with the host's memory behind it.
class MemoryRig : public BoardRig {
 protected:
  using Descriptor = std::array<std::uint32_t, vp::kDescriptorWords>;

  // A segment of `bytes` at `address` of the host's memory and at a place of one of the board's
  // apertures.
  static Descriptor descriptor(bool to_host, std::uint64_t address, std::uint32_t bytes,
                               vp::Aperture aperture, std::uint32_t place) {
    return {to_host ? 1U : 0U,
            bytes,
            static_cast<std::uint32_t>(address),
            static_cast<std::uint32_t>(address >> 32),
            static_cast<std::uint32_t>(offset_of(aperture)) + place,
            0,
            0,
            0};
  }

  // The bus is built; the board is, and is connected where it is a master.
  void connect_memory(std::size_t bytes) {
    memory_ = std::make_unique<vp::HostMemory>("memory", bytes);
    idle_ = std::make_unique<Stimulus>("idle", [](Stimulus&) {});
    idle_->to_target.bind(bus_->from_host);
    target_ = std::make_unique<vp::HostMemory>("target", 4);
    bus_->attach(target_->from_bus, 0x4000'0000, 4);
    if (accelerator_->dma() == nullptr) return;
    accelerator_->dma()->to_memory.bind(bus_->from_board);
    bus_->attach_memory(memory_->from_bus);
  }

  std::unique_ptr<vp::HostMemory> memory_, target_;
  std::unique_ptr<Stimulus> idle_;
};

}  // namespace hvp::test
