#include "models/fit/tissue_frames.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "models/collision/contact_search.h"
#include "models/collision/hand_over.h"
#include "models/config/input_error.h"
#include "models/time/picoseconds.h"

namespace hvp::fit {
namespace {

constexpr double kAside = 1e-6;            // m
constexpr std::size_t kFewestFrames = 20;  // as checked_log() wants them

// The frames [first, end) in which one node is the contact node.
struct Run {
  std::size_t first = 0;
  std::size_t end = 0;
  bool slid = false;  // another node was held in the frame before
};

std::vector<Run> runs_of(const std::vector<int>& node) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < node.size(); ++i) {
    if (node[i] < 0) continue;
    const bool begins = i == 0 || node[i - 1] != node[i];
    if (begins) runs.push_back({i, i, i > 0 && node[i - 1] >= 0});
    runs.back().end = i + 1;
  }
  return runs;
}

// Along one direction, as the servo loop goes through the frames of a run: m.
class Way {
 public:
  Way(const TissueBody& body, const TouchedFrames& frames, const Eigen::Vector3d& direction)
      : body_(body), frames_(frames), direction_(direction) {}

  // `offset`: of the node's place from the tip, along the direction, m.
  std::vector<double> of(const Run& run, double hand_over_s, double offset) const {
    collision::HandOver hand_over(to_picoseconds(hand_over_s));
    const std::array<double, 3> rest = {};
    const std::size_t last = run.first > 0 ? run.first - 1 : run.first;
    const std::size_t before = last > 0 ? last - 1 : last;
    const std::array<int, 1> node = {0};
    // A body without mass has no velocity.
    const std::span<const double> velocity =
        body_.dynamics ? std::span<const double>(rest) : std::span<const double>();
    hand_over.change(node, aim(run, before, offset), aim(run, last, offset), rest, velocity);
    std::vector<double> way;
    for (std::size_t i = run.first; i < run.end; ++i) {
      way.push_back(hand_over.hold(aim(run, i, offset), 0).displacement[0].x());
    }
    return way;
  }

 private:
  // x stands for the direction.
  collision::Aim aim(const Run& run, std::size_t frame, double offset) const {
    const auto node = static_cast<std::size_t>(frames_.contact_node[run.first]);
    const double along = direction_.dot(frames_.tip[frame] - body_.mesh.nodes[node]) + offset;
    return {to_picoseconds(frames_.time[frame]), {along, 0, 0}};
  }

  const TissueBody& body_;
  const TouchedFrames& frames_;
  Eigen::Vector3d direction_;
};

// The offset of the node from the tip (contact.grip = "offset"), as contact with a body at rest
// begins. It depends on the triangle that was touched, and the tip of the touch's first frame is
// still over it. Empty where contact slid there, from a surface that nobody has written down, or
// where the search finds another node.
std::optional<Eigen::Vector3d> grip_offset(collision::ContactSearch& search, const TissueBody& body,
                                           const TouchedFrames& frames, const Run& run) {
  if (run.slid) return std::nullopt;
  const std::vector<double> at_rest(3 * body.mesh.nodes.size(), 0.0);
  const std::array<collision::Touch, 1> touch = {{{.tip = frames.tip[run.first]}}};
  const collision::Contact found = search.pass(touch, at_rest).front().contact;
  if (found.node != frames.contact_node[run.first]) return std::nullopt;
  return found.offset;
}

void check(const TissueBody& body, const TouchedFrames& frames, const Eigen::Vector3d& direction) {
  const std::size_t size = frames.time.size();
  if (frames.tip.size() != size || frames.contact_node.size() != size ||
      frames.force.size() != size) {
    throw InputError(
        fmt::format("the frames have {} times, {} tips, {} contact nodes and {} "
                    "forces; expected as many of each",
                    size, frames.tip.size(), frames.contact_node.size(), frames.force.size()));
  }
  if (!direction.allFinite() || !(direction.norm() > 0)) {
    throw InputError("the contact's direction has no length; expected a vector such as 0 0 -1");
  }
  for (const int node : frames.contact_node) {
    if (node >= 0 && static_cast<std::size_t>(node) >= body.mesh.nodes.size()) {
      throw InputError(
          fmt::format("contact_node is {} and the mesh has {} nodes; expected the "
                      "mesh of the run",
                      node, body.mesh.nodes.size()));
    }
  }
}

}  // namespace

FrameTouches touches_of_frames(const TissueBody& body, const TouchedFrames& frames,
                               const Eigen::Vector3d& direction,
                               const collision::ContactSettings& contact) {
  check(body, frames, direction);
  const Eigen::Vector3d along = direction.normalized();
  const Way way(body, frames, along);
  const double hand_over_s = contact.hand_over_s;
  const bool snaps = contact.grip == collision::Grip::snap;
  std::optional<collision::ContactSearch> search;
  if (!snaps) search.emplace(body.mesh, body.anchored, contact);
  const auto fading = static_cast<std::size_t>(std::ceil(hand_over_s / body.period_s));
  FrameTouches result;
  std::size_t left_out = 0;
  for (const Run& run : runs_of(frames.contact_node)) {
    const std::size_t begin = run.slid ? run.first + fading : run.first;
    const bool rested = !body.dynamics || (result.logs.empty() && left_out == 0 && !run.slid);
    const std::optional<Eigen::Vector3d> offset =
        snaps ? Eigen::Vector3d::Zero() : grip_offset(*search, body, frames, run);
    if (!rested || !offset || run.end < begin + kFewestFrames) {
      ++left_out;
      continue;
    }
    const double aside = (*offset - along.dot(*offset) * along).norm();
    if (aside > kAside) {
      result.warnings.push_back(fmt::format(
          "contact holds node {} {:.2g} mm aside of its way, which the model leaves out: "
          "values may be off by more than their intervals",
          frames.contact_node[run.first], 1e3 * aside));
    }
    const std::vector<double> whole = way.of(run, hand_over_s, along.dot(*offset));
    TissueLog log;
    log.nodes = {frames.contact_node[run.first]};
    log.direction = direction;
    log.displacement.assign(whole.begin() + static_cast<std::ptrdiff_t>(begin - run.first),
                            whole.end());
    for (std::size_t i = begin; i < run.end; ++i) {
      log.time.push_back(frames.time[i]);
      log.force.push_back(-along.dot(frames.force[i]));
    }
    result.logs.push_back(std::move(log));
  }
  if (result.logs.empty()) {
    throw InputError(
        fmt::format("contact_node names no node for {} frames on end{}; expected a "
                    "run that touches the body",
                    kFewestFrames, body.dynamics ? " from the first touch on" : ""));
  }
  if (left_out > 0) {
    result.warnings.push_back(
        fmt::format("{} touches are left out: {}", left_out,
                    body.dynamics ? "the body still moves from the one before"
                                  : "they are too short, or slid there from another node"));
  }
  return result;
}

}  // namespace hvp::fit
