#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "models/config/figures.h"
#include "vp/frame/frame.h"

namespace hvp::results {

// Where the tip was near the body, or in it, without contact.
struct Approach {
  double distance = 0;  // m, of the tip from the surface as the collision process last had it;
                        // negative inside
  std::int64_t frame = 0;
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();

  void report(config::Figures& f) const;
};

// How the probe met the body: the table `contact`.
struct ContactFigures {
  std::int64_t frames = 0;
  std::int64_t frames_in_contact = 0;
  std::int64_t changes = 0;  // of the contact node
  std::int64_t collision_passes = 0;
  vp::Picoseconds longest_pass = 0;
  // The nearest place; none once the probe has touched the body.
  std::optional<Approach> nearest;
  // The deepest place in the body without contact, where that is a flag.
  std::optional<Approach> missed;

  // Of all frames, those in contact.
  double share() const {
    return frames > 0 ? static_cast<double>(frames_in_contact) / static_cast<double>(frames) : 0;
  }
  void report(config::Figures& f) const;
};

}  // namespace hvp::results
