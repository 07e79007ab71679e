#include "app/run/strain_watch.h"

#include <algorithm>

namespace hvp::app {

StrainWatch::StrainWatch(const fem::Body& body)
    : body_(body),
      meter_(body.mesh(), fem::kLinearStrain),
      displacement_(3 * body.mesh().nodes.size()) {}

void StrainWatch::solved(const vp::Frame& frame, const vp::Solution& solution) {
  if (frame.number % kEveryFrames != 0) return;
  body_.expand(solution.displacement, displacement_);
  const fem::Strains strains = meter_.measure(displacement_);
  const int inverted = std::max(worst_.inverted, strains.inverted);
  const double beyond = std::max(worst_.beyond_share, strains.beyond_share);
  if (worst_frame_ < 0 || strains.largest > worst_.largest) {
    worst_ = strains;
    worst_frame_ = frame.number;
  }
  worst_.inverted = inverted;
  worst_.beyond_share = beyond;
}

stability::Flags StrainWatch::flags() const {
  stability::Flags flags;
  if (fem::beyond_linearity(worst_)) flags.raise(stability::Flag::beyond_linearity);
  return flags;
}

}  // namespace hvp::app
