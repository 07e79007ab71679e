#pragma once

#include <cstdint>
#include <vector>

#include "models/fem/body.h"
#include "models/fem/linearity.h"
#include "models/stability/flag.h"
#include "vp/frame/observer.h"

namespace hvp::app {

// How far the body was strained, looked at every so many frames: a body that follows a hand does
// not change within them.
class StrainWatch : public vp::FrameObserver {
 public:
  static constexpr std::int64_t kEveryFrames = 20;
  // Keeps the reference.
  explicit StrainWatch(const fem::Body& body);

  void solved(const vp::Frame& frame, const vp::Solution& solution) override;

  // The frame with the largest strain; the most inverted elements of any frame.
  const fem::Strains& worst() const { return worst_; }
  std::int64_t worst_frame() const { return worst_frame_; }
  stability::Flags flags() const;

 private:
  const fem::Body& body_;
  fem::StrainMeter meter_;
  std::vector<double> displacement_;  // of all mesh nodes
  fem::Strains worst_;
  std::int64_t worst_frame_ = -1;
};

}  // namespace hvp::app
