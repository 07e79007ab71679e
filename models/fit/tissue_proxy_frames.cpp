#include "models/fit/tissue_proxy_frames.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::fit {
namespace {

constexpr std::size_t kFewestInTouch = 20;  // as checked_log() wants them
// A foot is written with all its digits.
constexpr double kOnSurface = 1e-9;  // of its distance from the origin and one metre

void expect_columns(const GlidingFrames& frames, const Eigen::Vector3d& direction) {
  const std::size_t size = frames.time.size();
  for (const std::size_t other : {frames.tip.size(), frames.contact_node.size(),
                                  frames.force.size(), frames.foot.size(), frames.slides.size()}) {
    if (other == size) continue;
    throw InputError(
        fmt::format("the frames have {} times and another column has {}; expected as many of each",
                    size, other));
  }
  if (!direction.allFinite() || !(direction.norm() > 0)) {
    throw InputError("the contact's direction has no length; expected a vector such as 0 0 -1");
  }
}

collision::SurfaceSpot spot_at(const ProxyPlaces& places, const Eigen::Vector3d& foot) {
  collision::SurfaceSpot spot = places.walk().nearest_at_rest(foot);
  const double off = (places.walk().rest(spot) - foot).norm();
  if (off <= kOnSurface * (1 + foot.norm())) return spot;
  throw InputError(fmt::format(
      "foot_x_m and so on are {:.3g} m from the surface at rest; expected the mesh of the run",
      off));
}

}  // namespace

FrameTouches touches_of_frames(const TissueBody& body, const GlidingFrames& frames,
                               const Eigen::Vector3d& direction, const ProxyProbe& probe) {
  expect_columns(frames, direction);
  const Eigen::Vector3d along = direction.normalized();
  const ProxyPlaces places(body);
  FrameTouches result;
  std::size_t left_out = 0;
  std::size_t end = 0;
  for (std::size_t first = 0; first < frames.time.size(); first = end) {
    end = first + 1;
    if (frames.contact_node[first] < 0) continue;
    while (end < frames.time.size() && frames.contact_node[end] >= 0) ++end;
    const bool rested = !body.dynamics || (result.logs.empty() && left_out == 0);
    if (!rested || end < first + kFewestInTouch) {
      ++left_out;
      continue;
    }
    TissueLog log;
    log.direction = direction;
    ProxyPath path{.radius_m = probe.radius_m, .friction = probe.friction};
    for (std::size_t i = first; i < end; ++i) {
      path.tip.push_back(frames.tip[i]);
      path.spot.push_back(spot_at(places, frames.foot[i]));
      path.slides.push_back(frames.slides[i]);
      log.time.push_back(frames.time[i]);
      log.displacement.push_back(along.dot(frames.tip[i] - frames.foot[i]));
      log.force.push_back(-along.dot(frames.force[i]));
    }
    log.proxy = std::move(path);
    result.logs.push_back(std::move(log));
  }
  if (result.logs.empty()) {
    throw InputError(fmt::format(
        "contact_node names no node for {} frames on end{}; expected a run that touches the body",
        kFewestInTouch, body.dynamics ? " from the first touch on" : ""));
  }
  if (left_out > 0) {
    result.warnings.push_back(fmt::format(
        "{} touches are left out: {}", left_out,
        body.dynamics ? "the body still moves from the one before" : "they are too short"));
  }
  return result;
}

ProxyPath press_at_node(const TissueBody& body, int node, const Eigen::Vector3d& direction,
                        std::span<const double> displacement, double radius_m) {
  if (!direction.allFinite() || !(direction.norm() > 0)) {
    throw InputError("the contact's direction has no length; expected a vector such as 0 0 -1");
  }
  const auto& triangles = body.mesh.boundary;
  const auto triangle = std::ranges::find_if(triangles, [&](const std::array<int, 3>& corners) {
    return std::ranges::find(corners, node) != corners.end();
  });
  if (triangle == triangles.end() || std::ranges::binary_search(body.anchored, node)) {
    throw InputError(fmt::format(
        "node {} is not on the body's surface, or anchored; expected one that a probe can touch",
        node));
  }
  collision::SurfaceSpot spot{static_cast<int>(triangle - triangles.begin())};
  spot.weight[std::ranges::find(*triangle, node) - triangle->begin()] = 1;
  ProxyPath path{.radius_m = radius_m, .friction = std::numeric_limits<double>::infinity()};
  const Eigen::Vector3d along = direction.normalized();
  for (const double depth : displacement) {
    path.tip.emplace_back(body.mesh.nodes[at(node)] + depth * along);
    path.spot.push_back(spot);
  }
  return path;
}

}  // namespace hvp::fit
