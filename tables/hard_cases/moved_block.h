#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "tables/hard_cases/model_cases.h"

// What the hard cases of bodies that are not linear are made of: a block, and a motion of its upper
// face.
namespace hvp::tables {

inline constexpr double kPeriodS = 2e-3;
inline constexpr double kCell = 5e-3;  // m
inline constexpr double kLocked = 0.4999;
inline constexpr double kUnlocked = 0.45;

// A block of 20 × 20 × 10 mm, clamped below, and how nodes of its upper face are led: `way` gives
// their displacement at a part of the motion from 0 to 1, then they are held for `rest` frames, or
// for as long again.
struct MovedBlock {
  double poisson_ratio = 0.45;
  double young_modulus_pa = 10e3;
  double contrast = 1;  // of the lowest layer's modulus over that of the others
  int layers = 2;
  int frames = 20;
  int rest = -1;        // as many frames as the motion
  double reach = 1e-9;  // m, of the nodes that are led, from the upper face's centre
  Eigen::Vector3d (*way)(double part, const Eigen::Vector3d& node) = nullptr;
};

fem::Body body_of(const MovedBlock& block);

// 5 mm down.
Eigen::Vector3d strike(double part, const Eigen::Vector3d& node);
// One node past the one below it.
Eigen::Vector3d through(double part, const Eigen::Vector3d& node);
// Onto the floor, where a clamped node is.
Eigen::Vector3d onto_the_floor(double part, const Eigen::Vector3d& node);
Eigen::Vector3d press(double part, const Eigen::Vector3d& node);           // 2 mm
Eigen::Vector3d press_a_little(double part, const Eigen::Vector3d& node);  // 0.2 mm
// The upper face about its own axis.
Eigen::Vector3d turn(double part, const Eigen::Vector3d& node);

// A case of this block, whose attempts are compared with the truth of their own plan.
ModelCase made(std::string name, std::string expected, Ending ending,
               std::optional<stability::Flag> flag, const ModelPlan& plan, const MovedBlock& block);

}  // namespace hvp::tables
