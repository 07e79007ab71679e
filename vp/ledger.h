#pragma once

#include <cstdint>
#include <vector>

#include "vp/frame.h"
#include "vp/tenure.h"

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
  void add_tenure_sink(TenureSink& sink) { tenure_sinks_.push_back(&sink); }

  // Who had a resource: handed on at once, nothing is kept. One of no length is none.
  void take(const Tenure& tenure) const;
  // Whether anybody wants to know.
  bool takes_tenures() const { return !tenure_sinks_.empty(); }

  // A frame is born at its release time. Numbers ascend.
  Frame& open(std::int64_t number, Picoseconds born);
  Frame& frame(std::int64_t number);
  // Whether it still is there to have spans.
  bool has(std::int64_t number) const;

  // Adds a span and returns its number. A tag without a frame (set-up) leaves no span.
  SpanId add(const Tag& tag, Part part, Phase phase, Picoseconds start, Picoseconds end);
  // As add, and the tag's cause becomes the new span.
  void extend(Tag& tag, Part part, Phase phase, Picoseconds start, Picoseconds end);

  // Something of the frame is still under way, a posted write or a DMA: the frame does not leave
  // before as many unhold(). A tag without a frame holds nothing.
  void hold(const Tag& tag);
  void unhold(const Tag& tag);
  bool holds() const { return held_ > 0; }  // any frame

  // The frame's process is done with it. It is handed on, with its critical path, as soon as
  // nothing holds it and all frames before it have been: here, or in a later close() or finish().
  // So every sink runs in the caller's process.
  void close(std::int64_t number);
  // At the end of a run, when nothing is under way: hands on what is left. Throws std::logic_error
  // where a closed frame is still held.
  void finish();

 private:
  struct Entry {
    Frame frame;
    int holds = 0;
    bool closed = false;
  };

  Entry& entry(std::int64_t number);
  void hand_on(const Frame& frame);
  void hand_on_ready();

  std::vector<Entry> open_;
  std::int64_t held_ = 0;
  std::vector<Frame> spare_;
  std::vector<SpanId> path_;
  std::vector<FrameSink*> sinks_;
  std::vector<TenureSink*> tenure_sinks_;
};

}  // namespace hvp::vp
