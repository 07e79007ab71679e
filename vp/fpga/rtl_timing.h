#pragma once

#include <memory>
#include <span>
#include <string>

#include "models/accel/architecture.h"
#include "models/fixed/settings.h"

namespace hvp::vp {

class JobTiming;

// The level rtl: the cycle-accurate engine, and beside it the one in SystemVerilog. Both are
// compared as rtl::RtlComparison says. The first load chooses among the sizes that the build has.
//
// Throws InputError with a key of accel::Architecture for an engine that cannot be translated, or
// with the key "fidelity.accelerator" where a build has none.
std::unique_ptr<JobTiming> make_rtl_timing(const accel::Architecture& architecture);

// Throws InputError with the key "fidelity.accelerator" where a build has no such engine.
void require_rtl();
// Throws InputError for what the level does not have in any size, with a key of
// accel::Architecture or of fixed::Settings; for what they do not have together, of the former.
void require_rtl(const accel::Architecture& architecture);
void require_rtl(const fixed::Settings& settings);
void require_rtl(const accel::Architecture& architecture, const fixed::Settings& settings);

// The size that engine.sv needs for a system, whose pattern is as in fixed::QuantisedMatrix.
struct RtlSize {
  std::string identifier;
  std::string parameters;  // as vp/fpga/rtl/CMakeLists.txt takes them
  bool built = false;      // this build has it, or one that serves as well
};
// Throws InputError as require_rtl() does, with the key "nodes" or "partitions" for a system that
// is too large for every size.
RtlSize rtl_size(const accel::Architecture& architecture, const fixed::Settings& settings,
                 std::span<const int> row_begin, std::span<const int> column);

}  // namespace hvp::vp
