#include "app/results/trace_lanes.h"

#include <algorithm>

#include <fmt/format.h>

namespace hvp::results {

namespace {

constexpr int kLanesOfARow = 1000;
constexpr std::array<std::string_view, static_cast<std::size_t>(Row::count)> kNames = {
    "host", "host waits", "bus", "bus waits", "fpga", "daq", "device"};
constexpr std::array kRowOfPart = {Row::host, Row::bus, Row::fpga, Row::daq, Row::device};
static_assert(kRowOfPart.size() == vp::kParts, "a part has no row");

}  // namespace

Row row_of(const vp::Span& span) {
  switch (span.phase) {
    case vp::Phase::release:
    case vp::Phase::wake_up:
    case vp::Phase::blocked:
    case vp::Phase::context_switch:
    case vp::Phase::wait:
    case vp::Phase::pipeline:
    case vp::Phase::delay:
      return Row::host_waits;
    case vp::Phase::arbitration:
      return Row::bus_waits;
    default:
      break;
  }
  return kRowOfPart.at(static_cast<std::size_t>(span.part));
}

TraceLanes::Lane TraceLanes::place(Row row, vp::Picoseconds start, vp::Picoseconds end) {
  std::vector<Slices>& lanes = rows_[static_cast<std::size_t>(row)];
  // Slices that only touch do not overlap; one without a length does within another.
  const auto overlaps = [start, end](const Slice& other) {
    return start < other.end && other.start < end;
  };
  auto lane = std::find_if(lanes.begin(), lanes.end(), [&overlaps](const Slices& slices) {
    return std::none_of(slices.begin(), slices.end(), overlaps);
  });
  const bool used = lane != lanes.end();
  if (!used) lane = lanes.emplace(lanes.end());
  lane->push_back({start, end});
  return {first_lane(row) + static_cast<int>(lane - lanes.begin()), used};
}

void TraceLanes::forget_before(vp::Picoseconds time) {
  for (std::vector<Slices>& lanes : rows_) {
    for (Slices& slices : lanes) {
      std::erase_if(slices, [time](const Slice& slice) { return slice.end <= time; });
    }
  }
}

int lane_of(vp::Resource resource) {
  return kLanesOfARow * (static_cast<int>(Row::count) + 1 + static_cast<int>(resource));
}

int first_lane(Row row) { return kLanesOfARow * (static_cast<int>(row) + 1); }

std::string lane_name(int lane) {
  const int place = lane / kLanesOfARow - 1;
  if (place >= static_cast<int>(Row::count)) {
    const auto resource = static_cast<vp::Resource>(place - static_cast<int>(Row::count));
    // Beside the lane of what frames have to do with it.
    if (resource == vp::Resource::bus) return "bus taken";
    return std::string(vp::name(resource));
  }
  const std::string_view row = kNames[static_cast<std::size_t>(place)];
  const int number = lane % kLanesOfARow;
  return number == 0 ? std::string(row) : fmt::format("{} {}", row, number + 1);
}

}  // namespace hvp::results
