#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/plant/moving_device.h"
#include "models/plant/plant.h"

namespace hvp::plant {

// The states of a device at each frame of 2 ms that a spring of 300 N/m pulls to `wall`, in two
// steps of the force, of which one comes shortly before the next frame. In between the device is
// asked where it is each `every`.
inline std::vector<PlantState> pulled_to_a_wall(const Plant& plant, const Eigen::Vector3d& wall,
                                                Picoseconds every) {
  constexpr Picoseconds kFrame = 2'000'000'000;
  constexpr int kFrames = 600;
  MovingDevice device(plant);
  std::vector<PlantState> seen;
  for (Picoseconds t = 0; t <= kFrames * kFrame; t += kFrame) {
    for (Picoseconds asked = t - kFrame + every; asked < t; asked += every) {
      if (asked > 0) device.at(asked);
    }
    const TipState tip = device.at(t);
    seen.push_back(device.plant());
    const Eigen::Vector3d force = 300 * (wall - tip.position);
    device.drive(t + 300'000'000, force);
    device.drive(t + 1'900'000'000, 0.7 * force);
  }
  return seen;
}

}  // namespace hvp::plant
