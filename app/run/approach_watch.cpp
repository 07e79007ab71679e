#include "app/run/approach_watch.h"

#include <Eigen/Geometry>

namespace hvp::app {

namespace {

// Of the body's diagonal at rest. A probe at 50 mm/s goes 2 mm in the 41 ms that a contact may be
// late with the defaults, and it is slow where it touches.
constexpr double kAllowed = 0.01;

double diagonal(const collision::DeformedSurface& surface) {
  Eigen::AlignedBox3d box;
  for (const int node : surface.surface_nodes()) box.extend(surface.rest_position(node));
  return box.diagonal().norm();
}

}  // namespace

ApproachWatch::ApproachWatch(const collision::ContactSearch& contacts)
    : contacts_(contacts), allowed_(kAllowed * diagonal(contacts.surface())) {}

void ApproachWatch::solved(const vp::Frame& frame, const vp::Solution& solution) {
  ContactWatch::solved(frame, solution);
  if (frame.in_contact()) {
    touched_ = true;
    figures_.nearest.reset();
    return;
  }
  const results::Approach here{contacts_.surface().signed_distance(frame.touch().tip), frame.number,
                               frame.touch().tip};
  std::optional<results::Approach>& nearest = figures_.nearest;
  if (!touched_ && (!nearest || here.distance < nearest->distance)) nearest = here;
  if (!deepest_ || here.distance < deepest_->distance) deepest_ = here;
}

results::ContactFigures ApproachWatch::figures() const {
  results::ContactFigures figures = figures_;
  figures.missed = missed();
  return figures;
}

std::optional<results::Approach> ApproachWatch::missed() const {
  if (!deepest_ || deepest_->distance > -allowed_) return std::nullopt;
  return deepest_;
}

stability::Flags ApproachWatch::flags() const {
  stability::Flags flags;
  if (missed()) flags.raise(stability::Flag::contact_missed);
  return flags;
}

}  // namespace hvp::app
