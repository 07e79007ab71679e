#pragma once

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "models/plant/kinematics.h"
#include "models/plant/linkages.h"

// The devices that the tests of kinematics try, each with poses all over its workspace.
namespace hvp::plant {

inline constexpr double kExact = 1e-12;
inline const Eigen::Vector3d kHome{0.01, -0.02, 0.03};
inline const SerialArmLinks kArm{0.215, 0.170};
inline const FiveBarLinks kPantograph{0.070, 0.090, 0.038};

// Numbers that every machine draws alike.
class Draw {
 public:
  double within(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_()) / 4294967295.0;
  }
  Eigen::Vector3d vector(double largest) {
    return {within(-largest, largest), within(-largest, largest), within(-largest, largest)};
  }

 private:
  std::mt19937 engine_{20020703};
};

struct Case {
  std::unique_ptr<Kinematics> kinematics;
  std::vector<Eigen::Vector3d> poses;  // on the branch, away from singular ones
};

// Every pose of a grid over the joints' travel.
template <class Regular>
std::vector<Eigen::Vector3d> poses(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                                   const Regular& regular) {
  std::vector<Eigen::Vector3d> found;
  constexpr int kSteps = 9;
  for (int i = 0; i < kSteps * kSteps * kSteps; ++i) {
    const Eigen::Vector3d share =
        Eigen::Vector3d(i % kSteps, i / kSteps % kSteps, i / (kSteps * kSteps)) /
        static_cast<double>(kSteps - 1);
    const Eigen::Vector3d q = low + share.cwiseProduct(high - low);
    if (regular(q)) found.push_back(q);
  }
  return found;
}

inline const double kPantographHeight = 0.070 + std::sqrt(0.090 * 0.090 - 0.019 * 0.019);

// Where the elbows of the five-bar are, q₃ being zero and the origin between its motors.
inline Eigen::Vector3d elbow(int motor, const Eigen::Vector3d& q) {
  const double side = motor == 0 ? -1 : 1;
  return {side * 0.019 + 0.070 * std::sin(q[motor]), 0, 0.070 * std::cos(q[motor])};
}

// The tip is up, both elbows to their own side of the line from motor to tip by more than 5 mm.
inline bool outwards(const Eigen::Vector3d& q) {
  const FiveBar linkage(kPantograph, {0, 0, kPantographHeight});
  const Eigen::Vector3d tip = linkage.tip({q[0], q[1], 0});
  const Eigen::Vector3d first(-0.019, 0, 0);
  const double left = (tip - first).normalized().cross(elbow(0, q) - first).y();
  const double right = (tip + first).normalized().cross(elbow(1, q) + first).y();
  return left < -0.005 && right > 0.005 && tip.z() > 0;
}

inline std::vector<Case> cases() {
  std::vector<Case> all;
  all.push_back({std::make_unique<SerialArm>(kArm, kHome),
                 poses({-1.5, -0.6, -0.5}, {1.5, 1.5, 2.0}, [](const Eigen::Vector3d& q) {
                   return std::abs(q[2] - q[1]) < 1.4 &&
                          kArm.upper_arm * std::cos(q[1]) + kArm.forearm * std::sin(q[2]) > 0.02;
                 })});
  all.push_back({std::make_unique<FiveBar>(kPantograph, kHome),
                 poses({-1.4, -0.5, -1.2}, {0.5, 1.4, 1.2},
                       [](const Eigen::Vector3d& q) { return outwards(q) && q[1] - q[0] < 1.7; })});
  return all;
}

// The apparent mass at the tip, kg, symmetric: (J·M⁻¹·Jᵀ)⁻¹ with M the diagonal of the joints'
// inertias, kg·m² (Khatib 1987). It is empty where the tip is out of reach or at a singular pose.
inline std::optional<Eigen::Matrix3d> apparent_mass(const Kinematics& kinematics,
                                                    const Eigen::Vector3d& joint_inertia,
                                                    const Eigen::Vector3d& tip) {
  const std::optional<Eigen::Vector3d> q = kinematics.regular_joints(tip);
  if (!q) return std::nullopt;
  const Eigen::Matrix3d inverse = kinematics.jacobian(*q).inverse();
  return Eigen::Matrix3d(inverse.transpose() * joint_inertia.asDiagonal() * inverse);
}

}  // namespace hvp::plant
