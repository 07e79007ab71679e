#pragma once

#include <vector>

#include "vp/frame/frame.h"
#include "vp/frame/frame_tag.h"
#include "vp/host/job_observer.h"
#include "vp/host/loop_health.h"

namespace hvp::vp {

// A frame on its way through the steps of the servo loop.
struct FrameStep {
  Frame* frame = nullptr;
  Tag tag = {};           // while another frame is worked on
  bool attempted = true;  // false: the solver is being brought back, or was given up
};

// What the servo loop makes a force of: a body that somebody solves (BodyRendering), or a wall
// (WallRendering). All calls are made in the servo thread, in the order of thesis Fig. 6.2, and
// take the simulated time that they cost.
class Rendering {
 public:
  virtual ~Rendering() = default;

  virtual std::size_t probes() const = 0;

  // Before the first frame: until frames can be taken. Throws std::runtime_error where they never
  // can.
  virtual void set_up() {}
  virtual void loop_begins(Picoseconds /*now*/) {}
  // After the last frame.
  virtual void close(std::int64_t /*ticks*/) {}

  // The tips have been read: what do they touch?
  virtual void look(Frame& /*frame*/) {}
  // Everything until somebody else works, and the host need not wait for it.
  virtual void begin(FrameStep& /*step*/) {}
  // Waits for that. Writes the forces on the body; without new ones the last ones stay.
  virtual void collect(FrameStep& step) = 0;
  // Of what is done with the solution before the force can go out: additions and multiplications.
  virtual double force_operations() const = 0;
  // Once the force is out.
  virtual void advance(Frame& /*frame*/) {}
  virtual void publish(const Frame& /*frame*/) {}
  virtual void note(const Frame& /*frame*/) {}
  virtual Solution solution() const { return {}; }

  // There is a solver to bring back, as far as the time until then allows.
  virtual bool recovers() const { return false; }
  virtual void recover(std::int64_t /*frame*/, Picoseconds /*until*/) {}

  virtual void report_to(FaultPlan& /*faults*/) {}
  virtual void observe_jobs(JobObserver& /*observer*/) {}
  virtual ServoCounts& counts() = 0;
};

}  // namespace hvp::vp
