#include "app/results/frames_csv.h"

#include <iterator>

#include <fmt/format.h>

#include "app/results/number_text.h"

namespace hvp::results {

FramesCsv::FramesCsv(const std::filesystem::path& path, const vp::Session& session,
                     vp::Picoseconds budget)
    : stream_(path), session_(session), budget_(budget) {
  stream_.write(
      "frame,born_us,latency_us,load_us,deadline_us,in_time,contact_node,contact_age_us,"
      "x_m,y_m,z_m,force_N,fx_N,fy_N,fz_N,saturations,flags\n");
}

void FramesCsv::take(const vp::Frame& f, const std::vector<vp::SpanId>& /*critical_path*/) {
  fmt::memory_buffer line;
  fmt::format_to(std::back_inserter(line), "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n",
                 f.number, microseconds(f.born - session_.begin), microseconds(f.latency()),
                 microseconds(f.work_done - f.born), microseconds(budget_),
                 f.latency() <= budget_ ? 1 : 0, f.contact_node, microseconds(f.contact_age),
                 shortest(f.position.x()), shortest(f.position.y()), shortest(f.position.z()),
                 shortest(f.force.norm()), shortest(f.force.x()), shortest(f.force.y()),
                 shortest(f.force.z()), f.saturations, f.flags);
  stream_.write({line.data(), line.size()});
}

}  // namespace hvp::results
