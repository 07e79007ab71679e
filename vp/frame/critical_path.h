#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vp/frame/frame.h"

namespace hvp::vp {

// What a phase of a part took of a frame's latency.
struct Attribution {
  Part part;
  Phase phase;
  Picoseconds time;
};

// The spans of a frame from its birth to the force at the motor, each the cause of the next, and
// what they add up to.
class CriticalPath {
 public:
  // Throws std::logic_error when the chain has a gap, an overlap, or does not start at the birth,
  // so that its spans sum to the latency exactly or the run fails. Allocates only for a path that
  // is longer than all before it.
  void follow(const Frame& frame);

  // In the order of time.
  const std::vector<SpanId>& spans() const { return spans_; }
  // Spans of one part and phase together, in the order of their first; sums to the latency.
  const std::vector<Attribution>& attribution() const { return attribution_; }
  Picoseconds time(Part part) const { return parts_[static_cast<std::size_t>(part)]; }
  // Of all parts.
  Picoseconds time(Phase phase) const;

 private:
  void add(const Span& span);

  std::vector<SpanId> spans_;
  std::vector<Attribution> attribution_;
  // An entry's number in attribution_ plus one; 0: there is none.
  std::array<std::uint16_t, kParts * kPhases> index_{};
  std::array<Picoseconds, kParts> parts_{};
};

}  // namespace hvp::vp
