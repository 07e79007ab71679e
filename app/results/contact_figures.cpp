#include "app/results/contact_figures.h"

namespace hvp::results {

void Approach::report(config::Figures& f) const {
  f.quantity("m", distance, "m", "the distance from the surface, negative inside");
  f.count("frame", frame, "in which frame");
}

void ContactFigures::report(config::Figures& f) const {
  f.count("changes", changes, "how often the contact node changed");
  f.count("collision_passes", collision_passes, "of the collision process");
  f.time("longest_pass_us", longest_pass, "the longest of them");
  f.ratio("share", share(), "of all frames, those in contact: with a node held");
}

}  // namespace hvp::results
