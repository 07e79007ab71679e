#pragma once

#include <optional>
#include <vector>

#include "models/host/wall.h"
#include "vp/frame/frame.h"
#include "vp/frame/servo_counts.h"
#include "vp/host/frame_solver.h"

namespace hvp::vp {

class FaultPlan;

// A frame on its way through the steps of the servo loop.
struct FrameStep {
  Frame* frame = nullptr;
  Tag tag = {};           // kept here while the process works on another frame
  bool attempted = true;  // false: the solver is being recovered, or was given up
};

// The source of the servo loop's forces: a body that is solved (BodyRendering), or a wall
// (WallRendering). All calls are made in the servo thread, in the order of thesis Fig. 6.2, and
// take the simulated time of their cost.
class Rendering {
 public:
  virtual ~Rendering() = default;

  virtual std::size_t probes() const = 0;

  // Sets up until frames can be taken; before the first frame. Throws std::runtime_error if that is
  // impossible.
  virtual void set_up() {}
  virtual void loop_begins(Picoseconds /*now*/) {}
  // To be called after the last frame.
  virtual void close(std::int64_t /*ticks*/) {}

  // Looks up the contacts of the tips, which have been read.
  virtual void look(Frame& /*frame*/) {}
  // Works until another part has the job and the host need not wait for it.
  virtual void begin(FrameStep& /*step*/) {}
  // Waits for the job. Writes the forces on the body; without new ones the last ones stay.
  virtual void collect(FrameStep& step) = 0;
  // The number of additions and multiplications between the solution and the force.
  virtual double force_operations() const = 0;
  // The following calls are made after the force is out.
  virtual void advance(Frame& /*frame*/) {}
  virtual void publish(const Frame& /*frame*/) {}
  virtual void note(const Frame& /*frame*/) {}
  virtual Solution solution() const { return {}; }

  // True if there is a solver to recover; recover() works as far as the time until then allows.
  virtual bool recovers() const { return false; }
  virtual void recover(std::int64_t /*frame*/, Picoseconds /*until*/) {}

  virtual void report_to(FaultPlan& /*faults*/) {}
  virtual void observe_jobs(JobObserver& /*observer*/) {}
  virtual ServoCounts& counts() = 0;
};

// A wall that the host renders by itself: no board, no collision process.
class WallRendering : public Rendering {
 public:
  WallRendering(const host::Wall& wall, double period_s, std::size_t probes)
      : wall_(wall), period_s_(period_s), before_(probes) {}

  std::size_t probes() const override { return before_.size(); }
  void begin(FrameStep& step) override;
  void collect(FrameStep& /*step*/) override {}
  double force_operations() const override {
    return host::Wall::kOperations * static_cast<double>(before_.size());
  }
  ServoCounts& counts() override { return counts_; }

 private:
  host::Wall wall_;
  double period_s_;
  std::vector<std::optional<double>> before_;  // depth in the frame before
  ServoCounts counts_;
};

}  // namespace hvp::vp
