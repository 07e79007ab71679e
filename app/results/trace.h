#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "app/results/part_stream.h"
#include "app/results/trace_lanes.h"
#include "vp/ledger.h"
#include "vp/session.h"

namespace hvp::results {

struct TraceSettings {
  std::int64_t frames = 1000;       // at most, from the first
  std::int64_t bytes = 64'000'000;  // of the whole file, at most
  vp::Picoseconds budget = 0;       // a force that comes later is marked
};

// trace.json: the spans as Chrome trace events ("Trace Event Format", Google, JSON object format),
// for Perfetto and chrome://tracing. A lane a part; what lies on its frame's critical path says so,
// and a chain of flow events ("s", "t", "f" with the frame's number) leads through it, from the
// frame's birth to the motor. Times are microseconds since the servo loop began.
class Trace : public vp::FrameSink {
 public:
  Trace(const std::filesystem::path& path, const vp::Session& session,
        const TraceSettings& settings);

  void take(const vp::Frame& frame, const std::vector<vp::SpanId>& critical_path) override;
  void finish();

  // The first frame that the bound on the file's size left out.
  std::optional<std::int64_t> cut_at() const { return cut_at_; }

 private:
  void write(std::string_view text);
  void name_lane(int lane);
  void append_slice(const vp::Frame& frame, std::size_t index, bool critical);
  void append_flow(const vp::Frame& frame, char phase, vp::Picoseconds at);
  void append_marks(const vp::Frame& frame);
  void append_time(vp::Picoseconds time);
  void cut(const vp::Frame& frame);

  PartStream stream_;
  const vp::Session& session_;
  TraceSettings settings_;
  std::int64_t frames_ = 0;
  std::int64_t written_ = 0;
  std::optional<std::int64_t> cut_at_;
  TraceLanes lanes_;
  int lane_ = 0;             // of the slice that was written last
  fmt::memory_buffer text_;  // of one frame
};

}  // namespace hvp::results
