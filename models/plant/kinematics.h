#pragma once

#include <Eigen/Core>
#include <optional>

// The geometry of a haptic device, and the resolution and force limit that its joints and motors
// have at the tip. Those two are empty where the tip is out of reach or at a singular pose.
namespace hvp::plant {

// A pose counts as singular beyond this ratio of the largest to the smallest singular value of J:
// the same torques then give a hundredth of the force in one direction that they give in another.
// It is a convention of ours; a PHANToM stays below 10 in its workspace.
inline constexpr double kLargestCondition = 100;

// The geometry of a device with three motors on its base: joints q (rad) and tip (m, in the
// coordinates of the body). All joints turn, so that every entry of J is in m/rad and its singular
// values can be compared. Torques follow from forces by the transpose, τ = Jᵀ·F.
class Kinematics {
 public:
  virtual ~Kinematics() = default;

  Eigen::Vector3d tip(const Eigen::Vector3d& q) const { return base_ + reach(q); }
  // The inverse, on the branch that the device's class states. Empty where the tip is out of reach
  // or NaN.
  std::optional<Eigen::Vector3d> joints(const Eigen::Vector3d& tip) const {
    return joints_reaching(tip - base_);
  }
  // The same, but empty at a singular pose too, where J cannot be inverted.
  std::optional<Eigen::Vector3d> regular_joints(const Eigen::Vector3d& tip) const;

  // ∂tip/∂q, m/rad. Not finite only at poses that are singular().
  virtual Eigen::Matrix3d jacobian(const Eigen::Vector3d& q) const = 0;
  // The condition number of J, at least 1; infinite where J is not of full rank or not finite.
  double condition(const Eigen::Vector3d& q) const;
  bool singular(const Eigen::Vector3d& q) const { return !(condition(q) <= kLargestCondition); }

 protected:
  // `base` is the origin of reach() in the coordinates of the body, m.
  explicit Kinematics(const Eigen::Vector3d& base) : base_(base) {}

 private:
  virtual Eigen::Vector3d reach(const Eigen::Vector3d& q) const = 0;
  virtual std::optional<Eigen::Vector3d> joints_reaching(const Eigen::Vector3d& reached) const = 0;

  Eigen::Vector3d base_;
};

// The resolution at the tip: its displacement as the joints move by a step (rad) together, which is
// the singular values of J·diag(step), m, largest first. The largest is the resolution that can be
// relied on.
std::optional<Eigen::Vector3d> resolution(const Kinematics& kinematics, const Eigen::Vector3d& step,
                                          const Eigen::Vector3d& tip);

// The largest force along `direction` (of any length but zero) that joint torques within
// ±`torque_limit` (N·m, positive) exert, N: the largest F with |Jᵀ·F·direction| within them.
std::optional<double> force_limit(const Kinematics& kinematics, const Eigen::Vector3d& torque_limit,
                                  const Eigen::Vector3d& tip, const Eigen::Vector3d& direction);

}  // namespace hvp::plant
