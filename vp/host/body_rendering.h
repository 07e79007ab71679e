#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "models/fixed/settings.h"
#include "models/host/contact_hold.h"
#include "models/host/costs.h"
#include "models/host/gliding_contact.h"
#include "vp/bus/host_memory.h"
#include "vp/host/board_access.h"
#include "vp/host/driver_port.h"
#include "vp/host/exchange.h"
#include "vp/host/frame_solver.h"
#include "vp/host/loop_health.h"
#include "vp/host/rendering.h"
#include "vp/host/soft_body.h"

namespace hvp::vp {

struct BodySettings {
  Picoseconds period = 2'000'000'000;
  host::Host costs;
  fixed::Settings solver;
  bool hold_saturated = false;  // a saturated solve gets a held force
  std::int64_t seed = 1;
};

// The rendering of a soft body in finite elements: fetch the contact node, form the modified force
// vector, send it, solve, receive U, form the force, then Newmark's update (thesis §6.2.2). Each
// step waits for its cost and adds its span. LoopHealth handles errors.
class BodyRendering : public Rendering {
 public:
  // Keeps references. `port` is the driver's connection to the board. `memory` is the memory that
  // the board's DMA engine reaches; null without one.
  BodyRendering(const BodySettings& settings, const SoftBody& soft, std::size_t probes,
                BoardAccess& access, const DriverPort& port, const Work& work, Exchange& exchange,
                HostMemory* memory = nullptr);
  ~BodyRendering() override;

  std::size_t probes() const override { return held_.contacts().size(); }
  void set_up() override;
  void loop_begins(Picoseconds now) override { health_.loop_begins(now); }
  void close(std::int64_t ticks) override;
  void look(Frame& frame) override;
  void begin(FrameStep& step) override;
  void collect(FrameStep& step) override;
  double force_operations() const override;
  void advance(Frame& frame) override;
  void publish(const Frame& frame) override;
  void note(const Frame& frame) override;
  Solution solution() const override { return {computation_.held(), computation_.displacement()}; }
  bool recovers() const override { return health_.recovers(); }
  void recover(std::int64_t frame, Picoseconds until) override { health_.recover(frame, until); }
  // Reports to the plan the faults that the driver notices.
  void report_to(FaultPlan& faults) override { health_.report_to(faults); }
  void observe_jobs(JobObserver& observer) override { solver_->observe(observer); }
  ServoCounts& counts() override { return health_.counts(); }

 private:
  void search(Frame& frame);
  void begin_with_nodes(FrameStep& step);
  void begin_with_proxies(FrameStep& step);
  void press(Frame& frame);
  void move_contact(Frame& frame);
  void renew(Frame& frame);

  BodySettings settings_;
  const fem::Body& body_;
  host::FrameComputation& computation_;
  BoardAccess& access_;
  const Work& work_;
  Exchange& exchange_;
  collision::ContactSearch& contacts_;
  std::unique_ptr<FrameSolver> solver_;
  LoopHealth health_;
  host::ContactHold held_;
  std::optional<host::GlidingContact> glides_;  // in place of held_'s nodes

  ContactReport report_;  // as the newest frame has read it
  std::vector<Eigen::Vector3d> forces_;
  // The sum for the mean force since the last report of the collision process.
  std::vector<Eigen::Vector3d> force_sum_;
  std::int64_t force_frames_ = 0;
  double set_up_operations_ = 0;
  // Scratch of a search in this frame.
  std::vector<collision::Touch> touches_;
  std::vector<Eigen::Vector3d> tips_;
  std::vector<double> displacement_;
};

}  // namespace hvp::vp
