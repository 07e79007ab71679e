#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "app/results/part_files.h"
#include "vp/fpga/master_access.h"
#include "vp/frame/frame.h"
#include "vp/frame/ledger.h"

namespace hvp::results {

// Rows of the timeline: one a part, and one each for the waits of the host and of the bus, which
// pass while others work.
enum class Row : std::uint8_t { host, host_waits, bus, bus_waits, fpga, daq, device, count };

Row row_of(const vp::Span& span);

// The second process has a track for each resource.
inline constexpr std::size_t kResources = static_cast<std::size_t>(vp::Resource::link_to_host) + 1;
int lane_of(vp::Resource resource);

// Places slices on tracks. Where slices of one row would overlap, as those of overlapping frames
// do, the later one gets a further track "bus 2", since viewers refuse slices that overlap without
// nesting.
class TraceLanes {
 public:
  struct Lane {
    int id;     // unique, ascending in the order of display; 1000·(row + 1) + number
    bool used;  // it had slices before
  };

  // The first track of the row on which [start, end] overlaps no slice placed before.
  Lane place(Row row, vp::Picoseconds start, vp::Picoseconds end);
  // States that no slice that begins earlier will come. Without this call every slice would be
  // remembered.
  void forget_before(vp::Picoseconds time);

 private:
  struct Slice {
    vp::Picoseconds start;
    vp::Picoseconds end;
  };
  using Slices = std::vector<Slice>;
  std::array<std::vector<Slices>, static_cast<std::size_t>(Row::count)> rows_;
};

// "host", "host waits", "bus 2"; "core 0", "bus taken".
std::string lane_name(int lane);
// The track of a row that exists before anything was placed.
int first_lane(Row row);

struct TraceSettings {
  std::int64_t frames = 1000;       // the most frames, from the first
  std::int64_t bytes = 64'000'000;  // the most bytes of the whole file
  vp::Picoseconds budget = 0;       // a force that comes later is marked
  // Time since the servo loop began; tenures that begin later are of frames that are not drawn.
  std::optional<vp::Picoseconds> end = std::nullopt;
};

// Writes trace.json: the ledger as Chrome trace events ("Trace Event Format", Google, JSON object
// format), for Perfetto and chrome://tracing. Times are microseconds since power-up: viewers drop
// events before zero, and set-up is drawn too.
//
// Process "hvp" has a track for each part with the frames' spans. Spans on their frame's critical
// path say so, and a chain of flow events ("s", "t", "f" with the frame's number) leads through
// them, from the frame's birth to the motor.
//
// Process "cores and buses" has a track for each resource with the tenures of all its users.
// Tenures of one user for one purpose that follow each other without a gap are one slice.
//
// Process "DMA", of a run that asks for it, has each transaction of the board's own.
class Trace : public vp::FrameObserver, public vp::TenureSink, public vp::MasterObserver {
 public:
  Trace(const std::filesystem::path& path, const vp::Session& session,
        const TraceSettings& settings);

  void closed(const vp::Frame& frame, const vp::CriticalPath& path) override;
  void take(const vp::Tenure& tenure) override;
  void transferred(const vp::MasterAccess& access) override;
  void finish();

  // The first frame that the limit on the file's size left out.
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
  bool is_beyond(vp::Picoseconds start) const;
  bool leaves_out_of_set_up(vp::Picoseconds start, vp::Picoseconds end);
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
  // The last tenure of each resource, which the next one may continue.
  std::array<std::optional<vp::Tenure>, kResources> last_;
  std::array<bool, kResources> named_{};
  bool dma_named_ = false;
  TraceLanes lanes_;
  int lane_ = 0;             // the track of the last slice
  fmt::memory_buffer text_;  // the events of one frame
};

}  // namespace hvp::results
