#include "app/results/frames_csv.h"

#include <iterator>

#include <fmt/format.h>

#include "app/results/number_text.h"
#include "driver/hvp_driver.h"

namespace hvp::results {

std::vector<FrameColumn> frame_columns() {
  std::vector<FrameColumn> columns = {
      {"frame", "number"},
      {"born_us", "its tick, since the servo loop began"},
      {"latency_us", "from its tick until its force is at the motor"},
      {"load_us", "from its tick until the host has done all its work"},
      {"deadline_us", "the latency that is allowed"},
      {"in_time", "1 where the force was in time and the frame's own"},
      {"contact_node", "mesh node, -1 without contact"},
      {"contact_age_us", "how old the collision pass was that found it"},
      {"x_m", "the tip as the host read it"},
      {"y_m", "likewise"},
      {"z_m", "likewise"},
      {"force_N", "the force on the probe: what the motor exerts"},
      {"fx_N", "its component"},
      {"fy_N", "likewise"},
      {"fz_N", "likewise"},
      {"saturations", "of the frame's solve"},
      {"flags", "likewise; bit n is entry n of `stability::Flag`"}};
  for (const std::string_view part : vp::kPartNames) {
    columns.push_back({fmt::format("{}_us", part),
                       "what the part added to the latency, on the critical path; all parts sum to "
                       "`latency_us` exactly"});
  }
  columns.push_back({"status",
                     "`HVP_OK`, or why the force of an earlier frame was held: what the driver "
                     "returned last ([driver.md](driver.md))"});
  return columns;
}

FramesCsv::FramesCsv(const std::filesystem::path& path, vp::Picoseconds budget, Columns columns)
    : stream_(path), budget_(budget), columns_(columns) {
  std::string header;
  for (const FrameColumn& column : frame_columns()) {
    header += (header.empty() ? "" : ",") + column.name;
  }
  stream_.write(header + "\n");
}

void FramesCsv::closed(const vp::Frame& f, const vp::CriticalPath& path) {
  const collision::Touch& touch = f.touch();
  fmt::memory_buffer line;
  const auto out = std::back_inserter(line);
  fmt::format_to(out, "{},{},{},{},{},{},{},{},{},{},{},", f.number, microseconds(f.time),
                 microseconds(f.latency()), microseconds(f.work_done - f.born),
                 microseconds(budget_), f.solved() && f.latency() <= budget_ ? 1 : 0,
                 touch.contact.node, microseconds(f.contact_age), shortest(touch.tip.x()),
                 shortest(touch.tip.y()), shortest(touch.tip.z()));
  if (columns_ == Columns::all) {
    const Eigen::Vector3d on_probe = Eigen::Vector3d::Zero() - touch.force;  // no negative zeros
    fmt::format_to(out, "{},{},{},{},{},", shortest(on_probe.norm()), shortest(on_probe.x()),
                   shortest(on_probe.y()), shortest(on_probe.z()), f.saturations);
  } else {
    fmt::format_to(out, ",,,,,");
  }
  fmt::format_to(out, "{}", f.flags);
  for (std::size_t part = 0; part < vp::kParts; ++part) {
    fmt::format_to(out, ",{}", microseconds(path.time(static_cast<vp::Part>(part))));
  }
  fmt::format_to(out, ",{}\n", hvp_status_name(f.status));
  stream_.write({line.data(), line.size()});
}

}  // namespace hvp::results
