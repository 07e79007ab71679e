#include "app/results/contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "app/results/number_text.h"
#include "app/scene/scene.h"
#include "models/stability/force_quality.h"

namespace hvp::results {

void Approach::report(config::Figures& f) const {
  f.quantity("m", distance, "m", "the distance from the surface, negative inside");
  f.count("frame", frame, "in which frame");
}

void ContactFigures::report(config::Figures& f) const {
  f.count("changes", changes,
          "frames in which a probe's contact node is another one than in the frame before");
  f.count("collision_passes", collision_passes, "of the collision process");
  f.time("longest_pass_us", longest_pass, "the longest of them");
  f.ratio("share", share(), "of all frames, those in contact");
  f.table_or_null("proxy", "where contact.kind is \"proxy\"; else null",
                  proxy.any() ? std::make_optional(proxy) : std::nullopt);
}

void ProxyFigures::add(const collision::Touch& touch, std::int64_t number) {
  if (!touch.contact.spot.present()) return;
  ++touches;
  if (touch.slides) ++sliding;
  largest_depth = std::max(largest_depth, touch.depth);
  // Of each probe in each frame: a deep press must not hide a shallow one.
  if (touch.force.norm() > stability::ForceQuality::kNoForce && touch.depth > 0) {
    largest_unresolved = std::max(largest_unresolved, touch.unresolved / touch.depth);
  }
  if (frame >= 0 && touch.gap <= largest_gap) return;
  largest_gap = touch.gap;
  frame = number;
}

void ProxyFigures::report(config::Figures& f) const {
  f.count("touches", touches, "frames in contact, counted for each probe");
  f.count("sliding", sliding, "those of them in which friction did not hold it");
  f.quantity("largest_gap_m", largest_gap, "m", "from a tip to the body's surface at its proxy");
  f.frame("largest_gap_frame", frame, "the frame that has it");
  f.ratio("largest_unresolved_rel", largest_unresolved,
          "of a tip's depth, in any frame of any probe, what a probe of its size would not have: "
          "elements are small beside it, or none of them is away from edges. Over a tenth: "
          "`contact-doubtful`");
  f.quantity("largest_depth_m", largest_depth, "m", "of a tip below the surface at rest");
  f.count("compliance_bytes", bytes, "of the table of the surface's compliances, on the host");
  f.count("compliance_solves", solves, "that the table took at set-up");
}

namespace {

// Body and probe of one scene belong to one hand: sizes further apart than this do not fit.
constexpr double kUnlikelyRatio = 50;
// The least and the largest size of a body that a hand grips or reaches, m.
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

struct Sizes {
  Eigen::AlignedBox3d body;
  Eigen::AlignedBox3d path;  // of the probe
};

Sizes sizes_of(const app::Scene& scene) {
  Sizes sizes;
  for (const Eigen::Vector3d& node : scene.body().mesh().nodes) sizes.body.extend(node);
  for (const plant::Trajectory& probe : scene.scenario().probes) {
    sizes.path.extend(probe.start);
    for (const plant::Segment& segment : probe.motion) sizes.path.extend(segment.to);
  }
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

std::string no_contact_text(const app::Scene& scene, const ContactFigures& contact) {
  std::string text;
  if (!scene.has_body()) return "  no contact     the tip did not reach the wall in these frames\n";
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "  no contact     {}\n",
                 contact.missed ? "nothing was held in these frames"
                                : "the probe did not touch the body in these frames");
  const auto [body, path] = sizes_of(scene);
  if (contact.nearest) {
    fmt::format_to(out, "    nearest      {} from the surface, in frame {} at {}\n",
                   readable_length(contact.nearest->distance), contact.nearest->frame,
                   point_text(contact.nearest->tip));
  }
  fmt::format_to(out, "    the body     {}\n    the probe    {}\n", extent_text(body),
                 extent_text(path));
  return text;
}

}  // namespace hvp::results
