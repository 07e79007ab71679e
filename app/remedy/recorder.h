#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/collision/contact_search.h"
#include "vp/host/servo_process.h"

namespace hvp::app {

// Where the probe was in a frame, and what it held.
struct Sighting {
  std::int64_t time = 0;  // ps, of the frame's birth
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();
  collision::Contact contact;
};

// What happened to the body in a run's first frames of contact, so that they can be solved again
// another way. Before there is contact the last two frames are kept, which the hand-over asks for.
class Recorder : public vp::FrameObserver {
 public:
  static constexpr std::size_t kMostFrames = 4096;

  explicit Recorder(std::int64_t frames);

  void solved(const vp::SolvedFrame& frame) override;

  const std::vector<Sighting>& sightings() const { return sightings_; }

 private:
  std::vector<Sighting> sightings_;
  bool touched_ = false;
};

}  // namespace hvp::app
