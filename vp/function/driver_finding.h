#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "models/time/picoseconds.h"

namespace hvp::vp {

// What a driver can do against the register map (docs/registers.md) or against PCI, and which the
// board does not always tell it: the accesses that show it are all of one order, that in which the
// board gets them. docs/driver-rules.md has what each means and what to do about it.
enum class DriverRule : std::uint8_t {
  illegal_access,         // an access that the map does not allow
  access_while_busy,      // of what is locked while a job runs
  command_ignored,        // a command while an error is pending
  start_unacknowledged,   // a start while the end of the job before is not acknowledged
  early_result,           // U or the results were read before the job's end was seen
  end_not_seen,           // the next job was started before this one's end was seen
  unloaded_matrix,        // a start after a setting has unloaded the matrix
  byte_order,             // a number that fits only with its bytes the other way round
  list_not_set,           // a doorbell without a list or a record since the last reset
  short_list,             // descriptors that do not move all of B or U
  owned_memory_touched,   // memory of a list changed while the board owned it
  owned_memory_unmapped,  // and was taken away
  no_bus_master,          // the board was to be bus master and may not
  stray_dma,              // a transaction of the board's that no memory answers
  interrupt_lost,         // the board has one and the function may not raise it
  line_left_up,           // the handler has returned and INTA# is up
  endless_wait,           // for a job that has no end
  count
};
inline constexpr auto kDriverRules = static_cast<std::size_t>(DriverRule::count);
struct RuleWords {
  std::string_view name;
  std::string_view meaning;
};

inline constexpr std::array<RuleWords, kDriverRules> kRuleWords = {{
    {"illegal-access", "an access that the register map does not allow"},
    {"access-while-busy", "an access to what is locked while a job runs"},
    {"command-ignored", "a command while an error is pending, which the board ignores"},
    {"start-unacknowledged", "a start while the end before is not acknowledged"},
    {"early-result", "a read of the results before the job's end was seen"},
    {"end-not-seen", "a start before the end of the job before was seen"},
    {"unloaded-matrix", "a start after a write that has unloaded the matrix"},
    {"byte-order", "a number that is in range only with its bytes the other way round"},
    {"list-not-set", "a doorbell without a list or a record since the last reset"},
    {"list-length", "descriptors that do not move exactly B or U"},
    {"owned-memory-touched", "memory of a list that changed while the board owned it"},
    {"owned-memory-unmapped", "memory of a list that was unmapped while the board owned it"},
    {"no-bus-master", "the board is to be bus master and may not"},
    {"stray-dma", "a transaction of the board that no memory answers"},
    {"interrupt-blocked", "an interrupt that was acknowledged and never told to the host"},
    {"line-left-up", "a handler that returned while its interrupt line was up"},
    {"endless-wait", "a wait without a time-out for a job that does not end"},
}};
static_assert(!kRuleWords.back().name.empty(), "a rule has no name");

constexpr std::string_view name(DriverRule rule) {
  return kRuleWords[static_cast<std::size_t>(rule)].name;
}
// What was done, in a few words.
constexpr std::string_view meaning(DriverRule rule) {
  return kRuleWords[static_cast<std::size_t>(rule)].meaning;
}

// How often a rule was broken, and the first time.
struct DriverFinding {
  DriverRule rule{};
  std::int64_t count = 0;
  Picoseconds first = 0;
  // The job, from 0 as in frames.csv; -1: none yet.
  std::int64_t job = -1;
  // The number of accesses to the BAR until then, which is the line of registers.log.
  std::int64_t access = 0;
  std::string what;
};

}  // namespace hvp::vp
