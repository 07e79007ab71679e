#include "vp/fpga/timing/job_timing.h"

#include "vp/fpga/timing/closed_form.h"
#include "vp/fpga/timing/every_clock.h"
#include "vp/fpga/timing/phase_by_phase.h"

namespace hvp::vp {

std::unique_ptr<JobTiming> make_job_timing(Timing level, const accel::Architecture& architecture) {
  switch (level) {
    case Timing::untimed:
    case Timing::loosely_timed:
      break;
    case Timing::approximately_timed:
      return std::make_unique<PhaseByPhase>(architecture);
    case Timing::cycle_accurate:
      return std::make_unique<EveryClock>(architecture);
  }
  return std::make_unique<ClosedForm>(architecture);
}

}  // namespace hvp::vp
