#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/link/pcie.h"

namespace hvp::vp {

// A register of the configuration space: its value after power-on, the bits that software may
// write, and those that it clears by writing a one.
struct ConfigRegister {
  std::size_t at = 0;
  std::size_t bytes = 4;
  std::uint32_t value = 0;
  std::uint32_t writable = 0;
  std::uint32_t cleared_by_one = 0;
  bool sticky = false;  // a reset of the function leaves it
};

// Places in the capability of PCI Express.
inline constexpr std::size_t kExpressControlAt = 0x08;
inline constexpr std::size_t kExpressStatusAt = 0x0a;
// Device Status and Device Control: which errors were found, and which are to be reported.
inline constexpr std::uint16_t kCorrectableError = 1;
inline constexpr std::uint16_t kNonFatalError = 2;
inline constexpr std::uint16_t kFatalError = 4;
inline constexpr std::uint8_t kExpressId = 0x10;

// The capability of PCI Express (version 2) of an endpoint on this link, for the place `at`, with
// `next` behind it in the list (PCI Express Base Specification 5.0, §7.5.3). Sizes of packets and
// the read completion boundary are as firmware has set them, the scenario's; software may write
// others, and the link keeps the scenario's.
std::vector<ConfigRegister> express_capability(const link::Pcie& link, std::size_t at,
                                               std::uint8_t next);

}  // namespace hvp::vp
