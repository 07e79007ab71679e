#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "vp/frame/frame.h"

namespace hvp::vp {

// The time that a phase of a part took of a frame's latency.
struct Attribution {
  Part part;
  Phase phase;
  Picoseconds time;
};

// The critical path of a frame: its spans from the birth to the force at the motor, each the cause
// of the next, and their sums.
class CriticalPath {
 public:
  // Throws std::logic_error if the chain has a gap or an overlap or does not start at the birth:
  // either its spans sum to the latency exactly or the run fails. Allocates only for a path longer
  // than all before it.
  void follow(const Frame& frame);

  // In the order of time.
  const std::vector<SpanId>& spans() const { return spans_; }
  // Sums by part and phase, in the order of their first span. They sum to the latency.
  const std::vector<Attribution>& attribution() const { return attribution_; }
  Picoseconds time(Part part) const { return parts_[static_cast<std::size_t>(part)]; }
  // The sum over all parts.
  Picoseconds time(Phase phase) const;

 private:
  void add(const Span& span);

  std::vector<SpanId> spans_;
  std::vector<Attribution> attribution_;
  // An entry's number in attribution_ plus one; 0: there is none.
  std::array<std::uint16_t, kParts * kPhases> index_{};
  std::array<Picoseconds, kParts> parts_{};
};

// An observer of frames: statistics, references, files, progress. It takes no simulated time.
class FrameObserver {
 public:
  virtual ~FrameObserver() = default;
  // Set-up is over, the servo loop begins.
  virtual void begun() {}
  // The frame has its displacements and its force. In a pipeline the force is not out yet, and more
  // spans may follow. Called in the order of the frames' numbers.
  virtual void solved(const Frame& /*frame*/, const Solution& /*solution*/) {}
  // No work of the frame is under way any more. Called in the order of the frames' numbers.
  virtual void closed(const Frame& /*frame*/, const CriticalPath& /*path*/) {}
};

// A resource with one user at a time.
enum class Resource : std::uint8_t {
  core_0,         // runs the servo process, and with one core the other process too
  core_1,         // runs the collision and graphics process
  bus,            // PCI
  link_to_board,  // PCI Express
  link_to_host,
};
std::string_view name(Resource resource);

// An interval in which one user has a resource. A frame's spans say what the frame took and waited
// for; tenures say what was taken, by any user: set-up, passes of the collision process and
// background traffic too. Those of one resource do not overlap, and those of a bus sum to its
// BusUse.
struct Tenure {
  Resource resource = Resource::bus;
  std::string_view user;  // processor, board, traffic, graphics; a process
  std::string_view what;  // a phase's name or another activity's
  std::int64_t frame = -1;
  Picoseconds start = 0;
  Picoseconds end = 0;
};

// A receiver of tenures, in the order of time for each resource.
class TenureSink {
 public:
  virtual ~TenureSink() = default;
  virtual void take(const Tenure& tenure) = 0;
};

// The record to which every part writes its spans. Several frames may be open at once. A closed
// frame goes to the observers and its storage is used again, so that memory does not grow with the
// run and the frame loop does not allocate.
class Ledger {
 public:
  // Observers are called in the order in which they were added.
  void add_observer(FrameObserver& observer) { observers_.push_back(&observer); }
  void add_tenure_sink(TenureSink& sink) { tenure_sinks_.push_back(&sink); }

  // Hands a tenure on at once and keeps nothing. A tenure of zero length is ignored.
  void take(const Tenure& tenure) const;
  // True if there is a receiver of tenures.
  bool takes_tenures() const { return !tenure_sinks_.empty(); }

  // The servo loop begins.
  void begin();
  // Opens the frame that is born at this tick. Numbers ascend. The frame stays at its address until
  // it is closed.
  Frame& open(std::int64_t number, Picoseconds born);
  Frame& frame(std::int64_t number);
  // True while the frame takes spans.
  bool has(std::int64_t number) const;

  // Adds a span and returns its number. A tag without a frame (set-up) leaves no span.
  SpanId add(const Tag& tag, Part part, Phase phase, Picoseconds start, Picoseconds end);
  // As add, and the tag's cause becomes the new span.
  void extend(Tag& tag, Part part, Phase phase, Picoseconds start, Picoseconds end);

  // The end of the tag's newest span, or its frame's birth. The tag has a frame.
  Picoseconds end_of(const Tag& tag);
  // Moves the end of the tag's newest span to a later time.
  void prolong(const Tag& tag, Picoseconds end);
  // Removes the frame's newest spans, from `first` on. No remaining span may follow one of them.
  void take_back(const Tag& tag, SpanId first);
  // The frame's force is at the motor at the end of the tag's newest span.
  void force_at_motor(const Tag& tag);
  // All work of the frame's period is done.
  void work_done(std::int64_t number, Picoseconds time) { frame(number).work_done = time; }
  // The frame has its displacements and its force.
  void solved(const Frame& frame, const Solution& solution) const;

  // Keeps the frame open for work that is still under way, a posted write or a DMA, until as many
  // calls of unhold(). A tag without a frame keeps none open.
  void hold(const Tag& tag);
  void unhold(const Tag& tag);
  bool holds() const { return held_ > 0; }  // any frame is kept open

  // The frame's process is done with it. The frame is handed on with its critical path as soon as
  // nothing keeps it open and all frames before it have been handed on: here, or in a later close()
  // or finish(), so that every observer runs in the caller's process.
  void close(std::int64_t number);
  // Hands on the remaining frames at the end of a run, when no work is under way. Throws
  // std::logic_error if a closed frame is still kept open.
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
