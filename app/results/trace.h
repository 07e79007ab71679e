#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "app/results/part_stream.h"
#include "app/results/trace_lanes.h"
#include "vp/frame/ledger.h"
#include "vp/frame/session.h"

namespace hvp::results {

struct TraceSettings {
  std::int64_t frames = 1000;       // at most, from the first
  std::int64_t bytes = 64'000'000;  // of the whole file, at most
  vp::Picoseconds budget = 0;       // a force that comes later is marked
  // Since the servo loop began: tenures that begin later are of frames that are not drawn.
  std::optional<vp::Picoseconds> end = std::nullopt;
};

// trace.json: the ledger as Chrome trace events ("Trace Event Format", Google, JSON object format),
// for Perfetto and chrome://tracing. Times are microseconds since power-up: viewers drop what is
// before zero, and set-up is drawn too.
//
// Process "hvp": a lane a part for the frames' spans. What lies on its frame's critical path says
// so, and a chain of flow events ("s", "t", "f" with the frame's number) leads through it, from the
// frame's birth to the motor.
//
// Process "cores and buses": a lane a resource for its tenures, whoever had it. Those that follow
// each other without a gap, of one user for one purpose, are one slice.
class Trace : public vp::FrameObserver, public vp::TenureSink {
 public:
  Trace(const std::filesystem::path& path, const vp::Session& session,
        const TraceSettings& settings);

  void closed(const vp::Frame& frame, const vp::CriticalPath& path) override;
  void take(const vp::Tenure& tenure) override;
  void finish();

  // The first frame that the bound on the file's size left out.
  std::optional<std::int64_t> cut_at() const { return cut_at_; }

 private:
  void write(std::string_view text);
  void name_lane(int lane);
  bool fits() const;
  void append_slice(const vp::Frame& frame, std::size_t index, bool critical);
  void append_flow(const vp::Frame& frame, char phase, vp::Picoseconds at);
  void append_marks(const vp::Frame& frame);
  void append_time(vp::Picoseconds time);
  void append_mark(std::string_view what, vp::Picoseconds at);
  void append_tenure(const vp::Tenure& tenure);
  void flush(std::optional<vp::Tenure>& tenure);
  void cut(std::int64_t frame, vp::Picoseconds at);

  PartStream stream_;
  const vp::Session& session_;
  TraceSettings settings_;
  std::int64_t frames_ = 0;
  std::int64_t next_frame_ = 0;
  std::int64_t written_ = 0;
  std::optional<std::int64_t> cut_at_;
  bool set_up_cut_ = false;  // set-up has a quarter of the bytes at most
  // Of each resource, what may go on.
  std::array<std::optional<vp::Tenure>, kResources> last_;
  std::array<bool, kResources> named_{};
  TraceLanes lanes_;
  int lane_ = 0;             // of the slice that was written last
  fmt::memory_buffer text_;  // of one frame
};

}  // namespace hvp::results
