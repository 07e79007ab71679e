// In the place of rtl_timing.cpp where Verilator was not installed when the build was configured.
#include "models/config/input_error.h"
#include "vp/fpga/job_timing.h"
#include "vp/fpga/rtl_timing.h"

namespace hvp::vp {

void require_rtl() {
  throw InputError("fidelity.accelerator",
                   "this build has no engine in SystemVerilog, as Verilator was not installed when "
                   "it was configured: expected \"cycle-accurate\"");
}

std::unique_ptr<JobTiming> make_rtl_timing(const accel::Architecture& /*architecture*/) {
  require_rtl();
  return nullptr;
}

void require_rtl(const accel::Architecture& /*architecture*/) { require_rtl(); }

void require_rtl(const fixed::Settings& /*settings*/) { require_rtl(); }

void require_rtl(const accel::Architecture& /*architecture*/, const fixed::Settings& /*settings*/) {
  require_rtl();
}

RtlSize rtl_size(const accel::Architecture& /*architecture*/, const fixed::Settings& /*settings*/,
                 std::span<const int> /*row_begin*/, std::span<const int> /*column*/) {
  require_rtl();
  return {};
}

}  // namespace hvp::vp
