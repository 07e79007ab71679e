#pragma once

#include <Eigen/Core>

#include "models/config/figures.h"
#include "models/plant/device.h"

namespace hvp::plant {

// What the host read, and what it then told the device, in one frame.
struct HostView {
  Eigen::Vector3d read = Eigen::Vector3d::Zero();   // position, m
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // on the device, N
  // In the body's or wall's spring, where that is known and not nothing at the start, J.
  double stored = 0;
};

// Where the work of a device's motors comes from, J, since the first frame. With x_n the tip's true
// position at the n-th latch, r_n as it was read, F_n the force that the host made of it, p_n the
// tip's place when that began to act, C_n what converter and current limit left of it:
//
//   body:       Σ ½(F_n + F_{n+1})·(r_{n+1} − r_n), what body or wall gave, as the host saw it
//
//   encoder:    Σ ½(F_n + F_{n+1})·(x_{n+1} − x_n) − body
//
//   latency:    Σ F_n·(p_{n+1} − p_n) − (body + encoder): the force is late, and held for a period
//
//   converter:  Σ (C_n − F_n)·(p_{n+1} − p_n)
//
//   amplifier:  what the motors really did − Σ C_n·(p_{n+1} − p_n)
//
// They sum to the motors' work by their definition. A part that is positive has fed energy into the
// motion. A body that is a spring gives nothing on a closed path; what it holds at the end is in
// its figure. (Colgate & Schenkel 1997 on the energy of a held force.)
class LoopEnergy {
 public:
  // Frames in their order: at its latch, `plant` the device's state then.
  void add(const HostView& view, const PlantState& plant);

  double body() const { return body_; }
  double encoder() const { return true_ - body_; }
  double latency() const { return last_.works.of_host - true_; }
  double converter() const { return last_.works.of_command - last_.works.of_host; }
  double amplifier() const { return last_.energy.by_motors - last_.works.of_command; }
  const Energy& energy() const { return last_.energy; }

  // The passivity observer (Hannaford & Ryu 2002): the least that all but masses and hand have
  // absorbed at any frame, with what the body's spring held at the start, J. Negative: the loop had
  // fed that much into the motion.
  double least_at_port() const { return least_; }
  std::int64_t least_frame() const { return least_frame_; }
  // Whether at any frame that was more than rounding and registers make: 1 µJ and a thousandth of
  // what had moved by then.
  bool active() const { return active_; }

  void report(config::Figures& f) const;

 private:
  bool any_ = false;
  HostView view_;
  PlantState last_;
  double body_ = 0;
  double true_ = 0;
  double at_start_ = 0;  // in the body's spring
  double least_ = 0;
  bool active_ = false;
  std::int64_t least_frame_ = -1;
  std::int64_t frames_ = 0;
};

}  // namespace hvp::plant
