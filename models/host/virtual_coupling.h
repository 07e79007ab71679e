#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>

#include "models/config/declaration.h"
#include "models/config/figures.h"
#include "models/host/wall.h"

namespace hvp::host {

// The effect [host.virtual_coupling]: body or wall do not see the device's tip but a virtual tool,
// which a spring and a damper couple to the position that was read (Colgate, Stanley & Brown 1995,
// "Issues in the Haptic Display of Tool Use"; Adams & Hannaford 1999, "Stable Haptic Interaction
// with Virtual Environments").
struct VirtualCoupling {
  double stiffness_N_m = 800;  // k_c
  double damping_N_s_m = 5;    // b_c
  // k_e, the stiffness by which the host expects a body's force to change as the tool moves.
  double expected_stiffness_N_m = 0;

  void declare(config::Visitor& v);

  // The stiffness at the device of a contact with `contact_N_m` behind the coupling's spring, at
  // rest: k·k_c/(k + k_c).
  double in_series(double contact_N_m) const {
    return contact_N_m * stiffness_N_m / (contact_N_m + stiffness_N_m);
  }
};

// The virtual tool of one probe. With x_n the position read, w_n the tool's place, e = x − w and f
// the force on what the tool touches, a tool without mass is in balance where
//
//   k_c·e_n + (b_c/T)·(e_n − e_{n−1}) = f(w_n)
//
// The force that the tool then meets at w_n goes to the device, so that no force is later for the
// coupling. A wall's f is known beforehand, and the balance is exact. A body's is known only after
// the solve; f_{n−1} + k_e·(w_n − w_{n−1}) stands for it, with k_e after a frame with a force
// alone. There e is of the force one frame before (two with a pipeline) where k_e is not the
// contact's stiffness k, and with the device at rest the tool settles where
// k < k_c + 2·b_c/T + 2·k_e.
class VirtualTool {
 public:
  VirtualTool(const VirtualCoupling& coupling, double period_s)
      : period_s_(period_s),
        damper_(coupling.damping_N_s_m / period_s),
        both_(coupling.stiffness_N_m + damper_),
        share_(both_ / (both_ + coupling.expected_stiffness_N_m)) {}

  // The tool's place w_n, m, from x_n and the force f_{n−1} on the body, N. The first call puts it
  // at x_0.
  Eigen::Vector3d follow(const Eigen::Vector3d& read, const Eigen::Vector3d& last_force);
  // Before a wall.
  Eigen::Vector3d follow(const Eigen::Vector3d& read, const Wall& wall);
  // Additions, multiplications and comparisons of each.
  static constexpr double kOperations = 3 + 3 + 3 + 3 + 3 + 6 + 3;
  static constexpr double kWallOperations = 3 + 3 + 3 + 5 + 5 + 4 + 6 + 3;

  // The largest |e|, m.
  double largest_stretch() const { return largest_; }

  void report(config::Figures& f) const;
  // Of no run.
  VirtualTool() : VirtualTool({}, 1) {}

 private:
  Eigen::Vector3d move_to(const Eigen::Vector3d& read, const Eigen::Vector3d& place);

  double period_s_;
  double damper_;  // b_c/T, N/m
  double both_;    // k_c + b_c/T
  double share_;   // of the way to where the last force would have it
  std::optional<Eigen::Vector3d> place_;
  Eigen::Vector3d stretch_ = Eigen::Vector3d::Zero();
  double largest_ = 0;
};

}  // namespace hvp::host
