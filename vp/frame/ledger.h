#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "vp/frame/critical_path.h"
#include "vp/frame/frame.h"
#include "vp/frame/observer.h"
#include "vp/frame/tenure.h"

namespace hvp::vp {

// Where every part writes what took time. Several frames may be open at once; a closed one goes
// to the observers and its storage is used again, so that memory does not grow with the run and the
// frame loop does not allocate.
class Ledger {
 public:
  // Observers are called in the order in which they were added.
  void add_observer(FrameObserver& observer) { observers_.push_back(&observer); }
  void add_tenure_sink(TenureSink& sink) { tenure_sinks_.push_back(&sink); }

  // Who had a resource: handed on at once, nothing is kept. One of no length is none.
  void take(const Tenure& tenure) const;
  // Whether anybody wants to know.
  bool takes_tenures() const { return !tenure_sinks_.empty(); }

  // The servo loop begins.
  void begin();
  // A frame is born at its release time. Numbers ascend. It stays where it is until it is closed.
  Frame& open(std::int64_t number, Picoseconds born);
  Frame& frame(std::int64_t number);
  // Whether it still is there to have spans.
  bool has(std::int64_t number) const;

  // Adds a span and returns its number. A tag without a frame (set-up) leaves no span.
  SpanId add(const Tag& tag, Part part, Phase phase, Picoseconds start, Picoseconds end);
  // As add, and the tag's cause becomes the new span.
  void extend(Tag& tag, Part part, Phase phase, Picoseconds start, Picoseconds end);

  // The span on which the tag stands ends later than was known, at `end`.
  void prolong(const Tag& tag, Picoseconds end);
  // Takes back the frame's newest spans, from `first` on; none of those that stay follows them.
  void take_back(const Tag& tag, SpanId first);
  // With the span on which the tag stands the frame's force is at the motor.
  void force_at_motor(const Tag& tag);
  // All work of the frame's period is done.
  void work_done(std::int64_t number, Picoseconds time) { frame(number).work_done = time; }
  // The frame has its displacements and its force.
  void solved(const Frame& frame, const Solution& solution) const;

  // Something of the frame is still under way, a posted write or a DMA: the frame does not leave
  // before as many unhold(). A tag without a frame holds nothing.
  void hold(const Tag& tag);
  void unhold(const Tag& tag);
  bool holds() const { return held_ > 0; }  // any frame

  // The frame's process is done with it. It is handed on, with its critical path, as soon as
  // nothing holds it and all frames before it have been: here, or in a later close() or finish().
  // So every observer runs in the caller's process.
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
  Span& span_of(const Tag& tag);
  void hand_on(const Frame& frame);
  void hand_on_ready();

  std::vector<std::unique_ptr<Entry>> open_;
  std::int64_t held_ = 0;
  std::vector<std::unique_ptr<Entry>> spare_;
  CriticalPath path_;
  std::vector<FrameObserver*> observers_;
  std::vector<TenureSink*> tenure_sinks_;
};

}  // namespace hvp::vp
