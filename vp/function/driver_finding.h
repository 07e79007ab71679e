#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "models/time/picoseconds.h"

namespace hvp::vp {

// What a driver can do against the register map (docs/registers.md) or against PCI, and which the
// board does not always tell it: the accesses that show it are all of one order, that in which the
// board gets them. docs/driver-rules.md has what each means and what to do about it.
enum class DriverRule : std::uint8_t {
  illegal_access,         // an access that the map does not allow
  access_while_busy,      // of what is locked while a job runs
  command_ignored,        // a second command while an error is pending
  start_unacknowledged,   // a start while the end of the job before is not acknowledged
  early_result,           // U or the results were read before the job's end was seen
  end_not_seen,           // the next job was started before this one's end was seen
  unloaded_matrix,        // a start after a setting has unloaded the matrix
  byte_order,             // a number that fits only with its bytes the other way round
  list_not_set,           // a doorbell without a list or a record since the last reset
  list_length,            // descriptors that do not move all of B or U
  owned_memory_touched,   // memory of a list changed while the board owned it
  owned_memory_unmapped,  // and was taken away
  missing_barrier,        // between a store to it and the board's access ([guest] memory_order)
  no_bus_master,          // the board was to be bus master and may not
  stray_dma,              // a transaction of the board's that no memory answers
  interrupt_blocked,      // the board has one and the function may not raise it
  line_left_up,           // the handler has returned and INTA# is up
  endless_wait,           // for a job that has no end
  count
};
inline constexpr auto kDriverRules = static_cast<std::size_t>(DriverRule::count);
inline constexpr std::array<std::string_view, kDriverRules> kRuleNames = {
    "illegal-access",       "access-while-busy",    "command-ignored",
    "start-unacknowledged", "early-result",         "end-not-seen",
    "unloaded-matrix",      "byte-order",           "list-not-set",
    "list-length",          "owned-memory-touched", "owned-memory-unmapped",
    "missing-barrier",      "no-bus-master",        "stray-dma",
    "interrupt-blocked",    "line-left-up",         "endless-wait",
};
static_assert(!kRuleNames.back().empty(), "a rule has no name");
constexpr std::string_view name(DriverRule rule) {
  return kRuleNames[static_cast<std::size_t>(rule)];
}

// The return addresses of the host's program, the innermost first; zeros behind the last.
using HostPlace = std::array<std::uintptr_t, 24>;

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
  // The address in the host's program, and its functions there, as "inner < outer": of the access
  // that is named, or of the start of the job whose transfer is. Zero and empty: not known.
  std::uintptr_t program_counter = 0;
  std::string function;
};

// What became of a watched driver: the rules that it broke, by the time of the first, and of how
// many accesses to the BAR that is said.
struct DriverReport {
  std::int64_t accesses = 0;
  std::vector<DriverFinding> findings;
};

}  // namespace hvp::vp
