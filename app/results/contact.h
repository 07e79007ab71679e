#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>

#include "models/config/figures.h"
#include "vp/frame/frame.h"

namespace hvp::app {
class Scene;
}

// Contact between probe and body: figures, and their texts for the terminal.

namespace hvp::results {

// A place where the tip was near the body, or in it, without contact.
struct Approach {
  double distance = 0;  // m, of the tip from the surface as the collision process last had it;
                        // negative inside
  std::int64_t frame = 0;
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();

  void report(config::Figures& f) const;
};

// The frames of proxies: the table `contact.proxy`.
struct ProxyFigures {
  std::int64_t touches = 0;       // frames in contact, counted for each probe
  std::int64_t sliding = 0;       // of them
  double largest_gap = 0;         // m
  std::int64_t frame = -1;        // that has it
  double largest_unresolved = 0;  // share of the tip's depth in that frame, of a force that is felt
  double largest_depth = 0;       // m, below the surface at rest
  // Set-up: the table, and the solves for it.
  std::int64_t bytes = 0;
  std::int64_t solves = 0;

  bool any() const { return bytes > 0; }
  bool too_soft() const { return largest_unresolved > 0.1; }
  void add(const collision::Touch& touch, std::int64_t number);
  void report(config::Figures& f) const;
};

// The table `contact` of summary.json.
struct ContactFigures {
  std::int64_t frames = 0;
  std::int64_t frames_in_contact = 0;
  std::int64_t changes = 0;  // of the contact node
  std::int64_t collision_passes = 0;
  vp::Picoseconds longest_pass = 0;
  ProxyFigures proxy;
  // The nearest place; absent once the probe has touched the body.
  std::optional<Approach> nearest;
  // The deepest place in the body without contact, where that is a flag.
  std::optional<Approach> missed;

  // The share of all frames that are in contact.
  double share() const {
    return frames > 0 ? static_cast<double>(frames_in_contact) / static_cast<double>(frames) : 0;
  }
  void report(config::Figures& f) const;
};

// A line that warns where the sizes of body and probe suggest a wrong unit; else empty.
std::string unit_text(const app::Scene& scene);

// Lines under the verdict of a run whose probe did not touch the body: how near it came, how large
// both are, and whether that looks like a mistake in a unit.
std::string no_contact_text(const app::Scene& scene, const ContactFigures& contact);

}  // namespace hvp::results
