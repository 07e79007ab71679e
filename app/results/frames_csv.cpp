#include "app/results/frames_csv.h"

#include <array>
#include <iterator>

#include <fmt/format.h>

#include "app/results/number_text.h"
#include "driver/hvp_driver.h"

namespace hvp::results {

namespace {

constexpr std::size_t kParts = 5;

// In the order of vp::Part, which is that of the columns.
std::array<vp::Picoseconds, kParts> by_part(const vp::Frame& frame,
                                            const std::vector<vp::SpanId>& path) {
  std::array<vp::Picoseconds, kParts> time{};
  for (const vp::SpanId id : path) {
    const vp::Span& span = frame.spans[static_cast<std::size_t>(id)];
    time[static_cast<std::size_t>(span.part)] += span.end - span.start;
  }
  return time;
}

}  // namespace

FramesCsv::FramesCsv(const std::filesystem::path& path, const vp::Session& session,
                     vp::Picoseconds budget, Columns columns)
    : stream_(path), session_(session), budget_(budget), columns_(columns) {
  stream_.write(
      "frame,born_us,latency_us,load_us,deadline_us,in_time,contact_node,contact_age_us,"
      "x_m,y_m,z_m,force_N,fx_N,fy_N,fz_N,saturations,flags,"
      "host_us,bus_us,fpga_us,daq_us,device_us,status\n");
}

void FramesCsv::take(const vp::Frame& f, const std::vector<vp::SpanId>& critical_path) {
  const std::array<vp::Picoseconds, kParts> path = by_part(f, critical_path);
  fmt::memory_buffer line;
  const auto out = std::back_inserter(line);
  fmt::format_to(
      out, "{},{},{},{},{},{},{},{},{},{},{},", f.number, microseconds(f.born - session_.begin),
      microseconds(f.latency()), microseconds(f.work_done - f.born), microseconds(budget_),
      f.solved && f.latency() <= budget_ ? 1 : 0, f.contact_node, microseconds(f.contact_age),
      shortest(f.position.x()), shortest(f.position.y()), shortest(f.position.z()));
  if (columns_ == Columns::all) {
    fmt::format_to(out, "{},{},{},{},{},", shortest(f.force.norm()), shortest(f.force.x()),
                   shortest(f.force.y()), shortest(f.force.z()), f.saturations);
  } else {
    fmt::format_to(out, ",,,,,");
  }
  fmt::format_to(out, "{}", f.flags);
  for (const vp::Picoseconds time : path) fmt::format_to(out, ",{}", microseconds(time));
  fmt::format_to(out, ",{}\n", hvp_status_name(static_cast<hvp_status>(f.status)));
  stream_.write({line.data(), line.size()});
}

}  // namespace hvp::results
