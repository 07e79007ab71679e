#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "models/config/declaration.h"

namespace hvp::host {

// The effect [wall]: a plane with a spring and a damper in the body's place, which the host renders
// by itself. It is the field's own benchmark (Colgate & Schenkel 1997; Abbott & Okamura 2005) and
// shows the effect of a latency on a loop, without anything else.
//
//   F = (K·d + B·(d − d_before)/T)·n,   d: the tip's depth behind the plane, n: its normal
//
// A wall with one side only pushes: F·n ≥ 0, and no force outside. One with both sides also pulls,
// so that its spring keeps the tip at the plane.
struct Wall {
  enum class Sides { one, both };

  double stiffness_N_m = 500;
  double damping_N_s_m = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // a point of the plane, m
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // points out of the wall; of any length
  Sides sides = Sides::one;

  void declare(config::Visitor& v);
  // Throws InputError: a normal of no length.
  void check() const;

  Eigen::Vector3d direction() const { return normal.normalized(); }
  // The tip's depth in the wall, m; negative in front of it.
  double depth(const Eigen::Vector3d& tip) const { return direction().dot(point - tip); }
  // The force on the tip, N, from its depths in this frame and in the one before, which are
  // period_s apart.
  Eigen::Vector3d force(double depth, double depth_before, double period_s) const;
  // The energy in its spring, J.
  double energy(const Eigen::Vector3d& tip) const {
    const double d = sides == Sides::one ? std::max(0.0, depth(tip)) : depth(tip);
    return 0.5 * stiffness_N_m * d * d;
  }
  // Additions and multiplications of depth() and force().
  static constexpr double kOperations = 5 + 3 + 2 + 3;
};

}  // namespace hvp::host
