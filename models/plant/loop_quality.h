#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "models/config/figures.h"
#include "models/plant/device.h"
#include "models/plant/oscillation.h"
#include "models/plant/output_stage.h"
#include "models/stability/flag.h"

namespace hvp::plant {

// The position that the host read and the force that it then commanded, in one frame.
struct HostView {
  Eigen::Vector3d read = Eigen::Vector3d::Zero();   // position, m
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // on the device, N
  // The energy in the body's or wall's spring, where that is known and not zero at the start, J.
  double stored = 0;
};

// The sources of the work of a device's motors, J, since the first frame. With x_n the tip's true
// position at the n-th latch, r_n the position that was read, F_n the force that the host made of
// it, p_n the tip's place when that began to act, and C_n the force that converter and current
// limit left of it:
//
//   body:       Σ ½(F_n + F_{n+1})·(r_{n+1} − r_n), the work of body or wall as the host saw it
//
//   encoder:    Σ ½(F_n + F_{n+1})·(x_{n+1} − x_n) − body
//
//   latency:    Σ F_n·(p_{n+1} − p_n) − (body + encoder): the force is late and constant for a
//   period
//
//   converter:  Σ (C_n − F_n)·(p_{n+1} − p_n)
//
//   amplifier:  the motors' real work − Σ C_n·(p_{n+1} − p_n)
//
// They sum to the motors' work by their definition. A positive part has fed energy into the motion.
// A body that is a spring gives nothing on a closed path; the energy that it stores at the end is
// in its figure. (Colgate & Schenkel 1997 on the energy of a force that is constant for a period.)
class LoopEnergy {
 public:
  // Adds a frame; frames come in their order. `plant` is the device's state at the frame's latch.
  void add(const HostView& view, const PlantState& plant);

  bool empty() const { return !any_; }  // no frame was added
  double body() const { return body_; }
  double encoder() const { return true_ - body_; }
  double latency() const { return last_.works.of_host - true_; }
  double converter() const { return last_.works.of_command - last_.works.of_host; }
  double amplifier() const { return last_.energy.by_motors - last_.works.of_command; }
  const Energy& energy() const { return last_.energy; }

  // The passivity observer (Hannaford & Ryu 2002): the least energy, over all frames, that
  // everything but masses and hand has absorbed, together with that of the body's spring at the
  // start, J. Negative: the loop had fed that much into the motion.
  double least_at_port() const { return least_; }
  std::int64_t least_frame() const { return least_frame_; }
  // True where in some frame the loop had fed energy in.
  bool active() const { return active_; }
  // The energy at the port is less than rounding and registers explain: less than nothing by 1 µJ
  // and by a thousandth of the energy that has moved by then.
  static bool fed_in(double at_port, const Energy& energy);

  void report(config::Figures& f) const;

 private:
  bool any_ = false;
  HostView view_;
  PlantState last_;
  double body_ = 0;
  double true_ = 0;
  double at_start_ = 0;  // energy in the body's spring
  double least_ = 0;
  bool active_ = false;
  std::int64_t least_frame_ = -1;
  std::int64_t frames_ = 0;
};

// The state of a device in one frame.
struct LoopSample {
  std::int64_t frame = 0;
  double time_s = 0;  // time of its latch
  HostView view;
  PlantState plant;
  Drive drive;
  bool read_wrong = false;   // the position read is not the tip's
  bool rests = false;        // the intended motion rests, or the device is in no hand
  bool unreachable = false;  // the joints have no regular pose for the tip
};

// The quality of a run's closed loop, for one device with mass.
class LoopQuality {
 public:
  // Adds a frame; frames come in their order.
  void add(const LoopSample& sample);

  bool empty() const { return energy_.empty(); }
  const LoopEnergy& energy() const { return energy_; }
  const RestWatch& rest() const { return rest_; }
  std::int64_t saturated_frames() const { return saturated_; }
  std::int64_t limit_frames() const { return at_limit_; }

  // The flags active-port, limit-cycle, force-saturated and device-at-its-limit.
  stability::Flags flags() const;
  void report(config::Figures& f) const;

 private:
  LoopEnergy energy_;
  RestWatch rest_;
  std::int64_t saturated_ = 0;
  std::int64_t at_limit_ = 0;
  double largest_force_ = 0;    // of the motors at latches, N
  double largest_speed_ = 0;    // m/s
  double largest_current_ = 0;  // A
  bool has_current_ = false;
};

}  // namespace hvp::plant
