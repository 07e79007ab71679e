#pragma once

#include <cstdint>
#include <vector>

#include "vp/frame.h"

namespace hvp::vp {

// The spans of a frame's critical path, from its birth to the force at the motor: the chain of
// causes. Throws std::logic_error when the chain has a gap, an overlap, or does not start at the
// birth, so that its spans sum to the latency exactly or the run fails.
std::vector<SpanId> critical_path(const Frame& frame);

// As above without an allocation: `path` keeps its capacity.
void critical_path(const Frame& frame, std::vector<SpanId>& path);

// Takes closed frames, in the order of their numbers.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  virtual void take(const Frame& frame, const std::vector<SpanId>& critical_path) = 0;
};

// Where every part writes what took time. Several frames may be open at once; a closed one goes
// to the sinks and its storage is used again, so that memory does not grow with the run and the
// frame loop does not allocate.
class Ledger {
 public:
  void add_sink(FrameSink& sink) { sinks_.push_back(&sink); }

  // A frame is born at its release time. Numbers ascend.
  Frame& open(std::int64_t number, Picoseconds born);
  Frame& frame(std::int64_t number);

  // Adds a span and returns its number. A tag without a frame (set-up) leaves no span.
  SpanId add(const Tag& tag, Part part, Phase phase, Picoseconds start, Picoseconds end);
  // As add, and the tag's cause becomes the new span.
  void extend(Tag& tag, Part part, Phase phase, Picoseconds start, Picoseconds end);

  // The frame has all its spans. Computes the critical path and hands it on.
  void close(std::int64_t number);

 private:
  std::vector<Frame> open_;
  std::vector<Frame> spare_;
  std::vector<SpanId> path_;
  std::vector<FrameSink*> sinks_;
};

}  // namespace hvp::vp
