#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "models/config/declaration.h"
#include "models/config/figures.h"

namespace hvp::host {

// The effect [host.passivity]: the host counts the energy at the device's port and damps where the
// loop has given more than it got (Hannaford & Ryu 2002, "Time-Domain Passivity Control of Haptic
// Interfaces", IEEE Trans. Robotics & Automation 18(1)).
struct Passivity {
  double largest_damping_N_s_m = 20;
  double largest_force_N = 8.5;

  void declare(config::Visitor& v);
};

// Observer and controller of one probe, in impedance causality: positions in, forces out. x_n is
// the position read, F_n the force that went to the device, as that on the body, f_n what the
// rendering asks for. Observer:
//
//   E_n = E_{n−1} + F_{n−1}·(x_n − x_{n−1})
//
// It takes the force that was held while the tip moved, and so sees what a held force gives (Ryu,
// Kim & Hannaford 2004, "Stability Guaranteed Control: Time Domain Passivity Approach", IEEE Trans.
// Control Systems Technology 12(6)); the 2002 paper takes F_n. Controller:
//
//   v = (x_n − x_{n−1})/T,  α_n = −E_n/(|v|²·T) where E_n < 0, else 0;  F_n = f_n + α_n·v
//
// A frame whose solve failed has the f of an earlier one, which is then counted and damped like
// any other. α_n is at most `largest_damping`, |α_n·v| at most `largest_force`: what they leave is
// still owed in the next frame.
class PassivityController {
 public:
  PassivityController(const Passivity& settings, double period_s)
      : settings_(settings), period_s_(period_s) {}

  // α_n·v, N. To be called once a frame, in order, with the newest x and with f.
  Eigen::Vector3d damping(const Eigen::Vector3d& read, const Eigen::Vector3d& force);

  // Additions, multiplications and comparisons of observing, and of damping beyond that.
  static constexpr double kObserves = 3 + 5 + 1 + 1;
  static constexpr double kDamps = 5 + 2 + 2 + 4 + 3 + 3;
  // True if the last call of damping() gave a force.
  bool acts() const { return acts_; }

  double observed_j() const { return energy_; }
  double least_j() const { return least_; }
  std::int64_t frames_acted() const { return acted_; }
  std::int64_t frames_bound() const { return bound_; }
  double largest_damping() const { return largest_; }

  void report(config::Figures& f) const;
  // Of no run.
  PassivityController() : PassivityController({}, 1) {}

 private:
  Passivity settings_;
  double period_s_;
  std::optional<Eigen::Vector3d> read_;             // x_{n−1}
  Eigen::Vector3d sent_ = Eigen::Vector3d::Zero();  // F_{n−1}
  double energy_ = 0;
  double least_ = 0;
  double largest_ = 0;
  bool acts_ = false;
  std::int64_t acted_ = 0;
  std::int64_t bound_ = 0;
};

}  // namespace hvp::host
