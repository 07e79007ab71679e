#include "app/results/verdict_text.h"

#include <Eigen/Geometry>
#include <iterator>

#include <fmt/format.h>

#include "app/results/fault_text.h"
#include "app/results/number_text.h"

namespace hvp::results {

namespace {

// Body and probe of one scene belong to one hand: sizes further apart than this do not fit.
constexpr double kUnlikelyRatio = 50;
// What a hand can hold or reach, m.
constexpr double kSmallestBody = 2e-3;
constexpr double kLargestBody = 2;

std::string extent_text(const Eigen::AlignedBox3d& box) {
  const auto range = [&box](int axis) {
    return fmt::format("{} to {}", readable_length(box.min()[axis]),
                       readable_length(box.max()[axis]));
  };
  return fmt::format("x {}, y {}, z {}", range(0), range(1), range(2));
}

std::string point_text(const Eigen::Vector3d& p) {
  return fmt::format("({}, {}, {})", readable_length(p.x()), readable_length(p.y()),
                     readable_length(p.z()));
}

}  // namespace

std::string_view verdict_word(const Outcome& o, bool timing_only) {
  if (o.partial()) return "held so far";
  if (!o.flags.empty()) return "held, with flags";
  if (faults_happened(o)) return "held, with faults";
  if (timing_only) return "PASS, timing only";
  if (o.contact_changes == 0) return "held; no contact";
  if (!o.accuracy_measured()) return "held; accuracy not measured";
  return "PASS";
}

namespace {

struct Sizes {
  Eigen::AlignedBox3d body;
  Eigen::AlignedBox3d path;  // of the probe
};

Sizes sizes_of(const app::Scene& scene) {
  Sizes sizes;
  for (const Eigen::Vector3d& node : scene.body().mesh().nodes) sizes.body.extend(node);
  const plant::Trajectory& probe = scene.scenario().probe;
  sizes.path.extend(probe.start);
  for (const plant::Segment& segment : probe.motion) sizes.path.extend(segment.to);
  return sizes;
}

}  // namespace

std::string unit_text(const app::Scene& scene) {
  const auto [body, path] = sizes_of(scene);
  const double size = body.diagonal().norm();
  const double way = std::max(path.diagonal().norm(), (path.center() - body.center()).norm());
  const bool unlikely = size < kSmallestBody || size > kLargestBody ||
                        way > kUnlikelyRatio * size || size > kUnlikelyRatio * way;
  if (!unlikely) return {};
  const bool from_file = !scene.scenario().object.mesh.surface.empty();
  return fmt::format(
      "  units       a body of {} and a probe that goes {}: these sizes do not fit one hand, check "
      "the units{}\n",
      readable_length(size), readable_length(way),
      from_file ? ", object.mesh.surface_unit first" : "");
}

std::string no_contact_text(const app::Scene& scene, const Outcome& o) {
  std::string text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "  no contact     {}\n",
                 o.missed_contact ? "nothing was held in these frames"
                                  : "the probe did not touch the body in these frames");
  const auto [body, path] = sizes_of(scene);
  if (o.approach) {
    fmt::format_to(out, "    nearest      {} from the surface, in frame {} at {}\n",
                   readable_length(o.approach->distance), o.approach->frame,
                   point_text(o.approach->tip));
  }
  fmt::format_to(out, "    the body     {}\n    the probe    {}\n", extent_text(body),
                 extent_text(path));
  return text;
}

}  // namespace hvp::results
