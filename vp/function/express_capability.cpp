#include "vp/function/express_capability.h"

#include <bit>

namespace hvp::vp {

namespace {

// The code of a packet's size: 0 for 128 bytes, 1 for 256, and so on.
std::uint32_t size_code(int bytes) {
  const auto size = static_cast<std::uint32_t>(bytes);
  return size <= 128 ? 0U : static_cast<std::uint32_t>(std::bit_width(size / 128) - 1);
}

// Device Capabilities: more than 32 tags, errors by their role, a reset of the function.
constexpr std::uint32_t kExtendedTags = 1U << 5U;
constexpr std::uint32_t kErrorsByRole = 1U << 15U;
constexpr std::uint32_t kFunctionReset = 1U << 28U;
// Device Control after power-on: relaxed ordering and no snoop are allowed. The bit that begins a
// reset of the function reads 0.
constexpr std::uint32_t kControl = 1U << 4U | 1U << 11U;
constexpr std::uint32_t kControlBits = 0x78ff;
// Device Status: correctable, non-fatal and fatal errors, an unsupported request.
constexpr std::uint32_t kStatusErrors = 0xf;
// Link Capabilities: §7.5.3.6 has every port of today set this bit.
constexpr std::uint32_t kOptionalAspm = 1U << 22U;
// Link Control: read completion boundary, common clock, extended synch.
constexpr std::uint32_t kBoundary128 = 1U << 3U;
constexpr std::uint32_t kLinkControlBits = 0xc8;

}  // namespace

std::vector<ConfigRegister> express_capability(const link::Pcie& link, std::size_t at,
                                               std::uint8_t next) {
  const std::uint32_t payload = size_code(link.max_payload_bytes);
  const std::uint32_t request = size_code(link.max_read_request_bytes);
  const bool many_tags = link.outstanding_reads > 32;
  // The codes of the speeds are 1 for Gen1, and so on (§7.5.3.6).
  const auto speed = static_cast<std::uint32_t>(link.generation) + 1U;
  const std::uint32_t speed_and_width = speed | static_cast<std::uint32_t>(link.lanes) << 4U;
  return {
      {at, 2, kExpressId | static_cast<std::uint32_t>(next) << 8U},
      {at + 0x02, 2, 2},  // version 2; an endpoint
      {at + 0x04, 4, payload | (many_tags ? kExtendedTags : 0U) | kErrorsByRole | kFunctionReset},
      {at + kExpressControlAt, 2, kControl | payload << 5U | request << 12U,
       kControlBits | (many_tags ? 1U << 8U : 0U)},
      {at + kExpressStatusAt, 2, 0, 0, kStatusErrors},
      {at + 0x0c, 4, speed_and_width | kOptionalAspm},
      {at + 0x10, 2, link.read_completion_boundary_bytes >= 128 ? kBoundary128 : 0U,
       kLinkControlBits},
      {at + 0x12, 2, speed_and_width},
      {at + 0x2c, 4, ((1U << speed) - 1U) << 1U},  // the speeds up to the link's
      {at + 0x30, 2, speed, 0xf},
  };
}

}  // namespace hvp::vp
