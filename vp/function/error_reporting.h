#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "vp/function/express_capability.h"

namespace hvp::vp {

// Errors of PCI Express that the function finds in what it receives.
enum class ExpressError : std::uint8_t {
  bad_packet,       // its CRC is wrong, and it comes again: correctable
  poisoned_packet,  // its sender has marked its data as wrong: uncorrectable
};

// The extended capability of advanced error reporting (PCI Express Base Specification 5.0, §7.8.4)
// and its places. The registers of errors are sticky: a reset of the function leaves them. The log
// of headers stays empty.
inline constexpr std::size_t kErrorsAt = 0x100;
inline constexpr std::size_t kUncorrectableAt = kErrorsAt + 0x04;
inline constexpr std::size_t kUncorrectableMaskAt = kErrorsAt + 0x08;
inline constexpr std::size_t kSeverityAt = kErrorsAt + 0x0c;
inline constexpr std::size_t kCorrectableAt = kErrorsAt + 0x10;
inline constexpr std::size_t kCorrectableMaskAt = kErrorsAt + 0x14;
inline constexpr std::uint32_t kPoisonedPacket = 1U << 12U;
inline constexpr std::uint32_t kBadPacket = 1U << 6U;

std::vector<ConfigRegister> error_capability();

}  // namespace hvp::vp
