#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "models/config/declaration.h"

namespace hvp::host {

// The effect [wall]: a plane with a spring and a damper in the body's place, which the host renders
// by itself. The field's own benchmark (Colgate & Schenkel 1997; Abbott & Okamura 2005): what a
// latency does to a loop, without anything else.
//
//   F = (K·d + B·(d − d_before)/T)·n,   d: how deep the tip is behind the plane, n: its normal
//
// A wall with one side pushes only: F·n ≥ 0, and none outside. One with both holds the tip at its
// plane, by a spring that pulls too.
struct Wall {
  enum class Sides { one, both };

  double stiffness_N_m = 500;
  double damping_N_s_m = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // of the plane, m
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // out of the wall; of any length
  Sides sides = Sides::one;

  void declare(config::Visitor& v);
  // Throws InputError: a normal of no length.
  void check() const;

  Eigen::Vector3d direction() const { return normal.normalized(); }
  // How deep the tip is in the wall, m; negative before it.
  double depth(const Eigen::Vector3d& tip) const { return direction().dot(point - tip); }
  // On the tip, N, by its depths in this frame and the one before, which lie period_s apart.
  Eigen::Vector3d force(double depth, double depth_before, double period_s) const;
  // In its spring, J.
  double energy(const Eigen::Vector3d& tip) const {
    const double d = sides == Sides::one ? std::max(0.0, depth(tip)) : depth(tip);
    return 0.5 * stiffness_N_m * d * d;
  }
  // Additions and multiplications of depth() and force().
  static constexpr double kOperations = 5 + 3 + 2 + 3;
};

}  // namespace hvp::host
