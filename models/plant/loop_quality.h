#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "models/config/figures.h"
#include "models/plant/device.h"
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
  // True where in some frame the energy fed in was more than rounding and registers explain: 1 µJ
  // and a thousandth of the energy that had moved by then.
  bool active() const { return active_; }

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

// Finds the oscillation in which a motion ends, while the user who moves the device rests. Each
// window of kWindowSeconds but the first is compared with the one before. A window that is not
// smaller than kSettles of the last one, turns at least kTurns times and moves by more than kFelt
// is a limit cycle; one that grows by more than kGrows is divergence. One that turns less often
// moves on: a device that flies or drifts away, or swings more slowly than 6 Hz (which a detector
// with longer windows finds). A motion that reverses by no more than kFelt does not count as a
// turn.
class Oscillation {
 public:
  static constexpr double kWindowSeconds = 0.25;
  static constexpr int kWindowFrames = 32;
  static constexpr double kSettles = 0.99;
  static constexpr double kGrows = 1.02;
  static constexpr int kTurns = 3;
  // Smallest vibration that skin feels, 0.1 µm peak at 250 Hz (Verrillo, J. Acoust. Soc. Am. 35,
  // 1963).
  static constexpr double kFelt = 0.2e-6;  // m, peak to peak

  struct Cycle {
    double amplitude_m = 0;  // half of peak to peak, along the worst axis
    double frequency_hz = 0;
    bool grows = false;
    std::int64_t frame = -1;  // the last frame of its window
  };

  explicit Oscillation(double window_s = kWindowSeconds) : window_s_(window_s) {}

  // Adds a frame; frames come in their order. `rests`: the intended motion rests.
  void add(std::int64_t frame, double time_s, const Eigen::Vector3d& position, bool rests);

  // The largest oscillation that was found; empty where no oscillation lasts or nothing rested long
  // enough.
  const std::optional<Cycle>& cycle() const { return worst_; }
  // The distance that the last window moved over its length, m/s; empty where it settled or swung.
  const std::optional<double>& moves_on() const { return moves_on_; }
  // True where at least two windows could be compared.
  bool measured() const { return measured_; }

 private:
  struct Window {
    double began_s = 0;
    double ended_s = 0;
    std::int64_t frames = 0;
    Eigen::Vector3d least = Eigen::Vector3d::Zero();
    Eigen::Vector3d most = Eigen::Vector3d::Zero();
    Eigen::Vector3d turned = Eigen::Vector3d::Zero();  // the farthest place since the last turn
    Eigen::Vector3d heading =
        Eigen::Vector3d::Zero();  // signs of the motion since then; 0: none yet
    Eigen::Array3i turns = Eigen::Array3i::Zero();
  };
  void begin(double time_s, const Eigen::Vector3d& position);
  void close(std::int64_t frame);

  double window_s_;
  Window window_;
  std::optional<Eigen::Vector3d> before_;  // peak to peak of the window before
  std::optional<Cycle> worst_;
  std::optional<double> moves_on_;
  bool measured_ = false;
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

  const LoopEnergy& energy() const { return energy_; }
  const Oscillation& oscillation() const { return oscillation_; }
  // The oscillation that lasts: a fast one or, without one, a slow one.
  const std::optional<Oscillation::Cycle>& cycle() const {
    return oscillation_.cycle() ? oscillation_.cycle() : slow_.cycle();
  }
  std::int64_t saturated_frames() const { return saturated_; }
  std::int64_t limit_frames() const { return at_limit_; }

  // The flags active-port, limit-cycle, force-saturated and device-at-its-limit.
  stability::Flags flags() const;
  void report(config::Figures& f) const;

 private:
  static constexpr double kSlowWindowSeconds = 1.5;  // swings from 1 Hz on

  LoopEnergy energy_;
  Oscillation oscillation_;
  Oscillation slow_{kSlowWindowSeconds};
  std::int64_t saturated_ = 0;
  std::int64_t at_limit_ = 0;
  double largest_force_ = 0;    // of the motors at latches, N
  double largest_speed_ = 0;    // m/s
  double largest_current_ = 0;  // A
  bool has_current_ = false;
};

}  // namespace hvp::plant
