#include "models/collision/hand_over.h"

namespace hvp::collision {

void HandOver::begin(std::int64_t now, std::int64_t duration, const Eigen::Vector3d& gap) {
  began_ = now;
  duration_ = duration;
  gap_ = gap;
}

Eigen::Vector3d HandOver::gap(std::int64_t now) const {
  const std::int64_t elapsed = now - began_;
  if (elapsed >= duration_) return Eigen::Vector3d::Zero();
  const double t = static_cast<double>(elapsed) / static_cast<double>(duration_);
  return (1.0 - t * t * t * (10.0 - 15.0 * t + 6.0 * t * t)) * gap_;
}

}  // namespace hvp::collision
