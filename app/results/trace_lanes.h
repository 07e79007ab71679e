#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "vp/frame/frame.h"
#include "vp/frame/tenure.h"

namespace hvp::results {

// Rows of the timeline: one a part, and one each for what the host and the bus wait for, beside
// others' work. Where slices of one row would overlap, as those of overlapping frames do, the later
// one gets a further row "bus 2", since viewers refuse slices that overlap without nesting.
enum class Row : std::uint8_t { host, host_waits, bus, bus_waits, fpga, daq, device, count };

Row row_of(const vp::Span& span);

// Lanes of the second process: one a resource.
inline constexpr std::size_t kResources = static_cast<std::size_t>(vp::Resource::link_to_host) + 1;
int lane_of(vp::Resource resource);

class TraceLanes {
 public:
  struct Lane {
    int id;     // unique, ascending in the order of display; 1000·(row + 1) + number
    bool used;  // before
  };

  // The first lane of the row in which [start, end] overlaps no slice placed before.
  Lane place(Row row, vp::Picoseconds start, vp::Picoseconds end);
  // No slice that begins earlier will come. Without it every slice would be remembered.
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
// The lane of a row that is there before anything was placed.
int first_lane(Row row);

}  // namespace hvp::results
