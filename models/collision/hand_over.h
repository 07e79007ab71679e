#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace hvp::collision {

// Takes a node over from where it is to where the contact wants it, within a while. The contact
// is found late and the next node lies beside the tip, so that the prescribed displacement would
// jump; to a body with mass a jump is a blow, after which force and contact ring.
//
// The gap between the two places closes as 1 − (10τ³ − 15τ⁴ + 6τ⁵), τ = time/duration: without a
// jump of position, velocity or acceleration. A duration of zero jumps, as thesis §3.7 does.
class HandOver {
 public:
  // `gap`: where the node is less where it is wanted, m. Times in picoseconds.
  void begin(std::int64_t now, std::int64_t duration, const Eigen::Vector3d& gap);

  // What is left of the gap.
  Eigen::Vector3d gap(std::int64_t now) const;

 private:
  std::int64_t began_ = 0;
  std::int64_t duration_ = 0;
  Eigen::Vector3d gap_ = Eigen::Vector3d::Zero();
};

}  // namespace hvp::collision
