#include "vp/function/error_reporting.h"

namespace hvp::vp {

namespace {

// The errors of the table after power-on that are fatal, and the correctable one that is masked:
// those of §7.8.4.4 and §7.8.4.6.
constexpr std::uint32_t kFatalAtFirst = 0x0046'2030;
constexpr std::uint32_t kAdvisory = 1U << 13U;

constexpr std::uint32_t kErrorsHeader = 0x0001'0001;  // version 1; the last in its list

}  // namespace

std::vector<ConfigRegister> error_capability() {
  return {
      {.at = kErrorsAt, .value = kErrorsHeader},
      {.at = kUncorrectableAt, .cleared_by_one = kPoisonedPacket, .sticky = true},
      {.at = kUncorrectableMaskAt, .writable = kPoisonedPacket, .sticky = true},
      {.at = kSeverityAt, .value = kFatalAtFirst, .writable = kPoisonedPacket, .sticky = true},
      {.at = kCorrectableAt, .cleared_by_one = kBadPacket, .sticky = true},
      {.at = kCorrectableMaskAt,
       .value = kAdvisory,
       .writable = kAdvisory | kBadPacket,
       .sticky = true},
  };
}

}  // namespace hvp::vp
