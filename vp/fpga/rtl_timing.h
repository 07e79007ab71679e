#pragma once

#include <memory>

#include "models/accel/architecture.h"
#include "models/fixed/settings.h"

namespace hvp::vp {

class JobTiming;

// The level rtl: the cycle-accurate engine, and beside it the one in SystemVerilog. Both are
// compared as rtl::RtlComparison says.
//
// Throws InputError with a key of accel::Architecture for an engine that has not been translated,
// or with the key "fidelity.accelerator" where a build has none.
std::unique_ptr<JobTiming> make_rtl_timing(const accel::Architecture& architecture);

// Throws InputError with the key "fidelity.accelerator" where a build has no such engine.
void require_rtl();
// Throws InputError for what the level does not have, with a key of accel::Architecture or of
// fixed::Settings.
void require_rtl(const accel::Architecture& architecture);
void require_rtl(const fixed::Settings& settings);

}  // namespace hvp::vp
