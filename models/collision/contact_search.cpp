#include "models/collision/contact_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::collision {

namespace {

constexpr std::size_t kLargestPatches = std::size_t{1} << 22;  // 16 MiB

}  // namespace

ContactSearch::ContactSearch(const mesh::TetMesh& mesh, std::span<const int> anchored,
                             const ContactSettings& settings)
    : settings_(settings), surface_(mesh), anchored_(mesh.nodes.size(), 0) {
  for (const int node : anchored) {
    if (node < 0 || node >= surface_.nodes()) {
      throw InputError(
          fmt::format("anchored node {}; the mesh has {} nodes", node, surface_.nodes()));
    }
    anchored_[at(node)] = 1;
  }
  const auto& nodes = surface_.surface_nodes();
  if (std::none_of(nodes.begin(), nodes.end(), [&](int n) { return anchored_[at(n)] == 0; })) {
    throw InputError(
        fmt::format("all {} surface nodes are anchored; nothing can be touched", nodes.size()));
  }
  if (settings_.patch_radius > 0.0) find_patches();

  const double depth = std::log2(static_cast<double>(surface_.triangles().size())) + 1.0;
  const SearchCost one_leaf{.boxes = 2 * static_cast<long>(depth), .triangles = 4, .nodes = 3};
  pass_flops_ = surface_.update_flops() + one_leaf.flops();
}

void ContactSearch::find_patches() {
  const double square = settings_.patch_radius * settings_.patch_radius;
  std::vector<int> seen_from(anchored_.size(), -1);
  patch_begin_.assign(anchored_.size() + 1, 0);
  for (int centre = 0; centre < surface_.nodes(); ++centre) {
    const std::size_t begin = patch_.size();
    if (touchable(centre)) {
      seen_from[at(centre)] = centre;
      patch_.push_back(centre);
      for (std::size_t next = begin; next < patch_.size(); ++next) {
        for (const int triangle : surface_.ring(patch_[next])) {
          for (const int node : surface_.triangles()[at(triangle)]) {
            if (seen_from[at(node)] == centre || anchored_[at(node)] != 0) continue;
            seen_from[at(node)] = centre;
            const Eigen::Vector3d apart =
                surface_.rest_position(node) - surface_.rest_position(centre);
            if (apart.squaredNorm() <= square) patch_.push_back(node);
          }
        }
      }
      std::sort(patch_.begin() + static_cast<std::ptrdiff_t>(begin), patch_.end());
      if (patch_.size() > kLargestPatches) {
        throw InputError(
            "patch_radius",
            fmt::format("{} m puts {} nodes into the patch of node {} and more than "
                        "{} into all; expected a few elements",
                        settings_.patch_radius, patch_.size() - begin, centre, kLargestPatches));
      }
    }
    patch_begin_[at(centre) + 1] = static_cast<int>(patch_.size());
  }
}

bool ContactSearch::touchable(int node) const {
  return node >= 0 && node < surface_.nodes() && anchored_[at(node)] == 0 &&
         surface_.on_surface(node);
}

std::span<const int> ContactSearch::patch(int node) const {
  if (!touchable(node)) {
    throw InputError(fmt::format("node {} is not a free node of the surface", node));
  }
  if (patch_begin_.empty()) {
    const auto& nodes = surface_.surface_nodes();
    return {&*std::lower_bound(nodes.begin(), nodes.end(), node), 1};
  }
  const std::size_t begin = at(patch_begin_[at(node)]);
  return {patch_.data() + begin, at(patch_begin_[at(node) + 1]) - begin};
}

Eigen::Vector3d ContactSearch::prescribed_displacement(const Contact& contact,
                                                       const Eigen::Vector3d& tip) const {
  if (!touchable(contact.node)) {
    throw InputError(fmt::format("node {} is not a free node of the surface", contact.node));
  }
  return tip + contact.offset - surface_.rest_position(contact.node);
}

Eigen::Vector3d ContactSearch::grip_offset(const Eigen::Vector3d& node_position,
                                           const Eigen::Vector3d& tip,
                                           const Eigen::Vector3d& normal) const {
  if (settings_.grip == Grip::snap) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d apart = node_position - tip;
  return apart - apart.dot(normal) * normal;
}

Eigen::Vector3d ContactSearch::undragged(int node, const Eigen::Vector3d& displacement) const {
  const Eigen::Vector3d& normal = surface_.rest_normal(node);
  return surface_.rest_position(node) + displacement.dot(normal) * normal;
}

Pass ContactSearch::start(const Eigen::Vector3d& tip, SearchCost& cost) const {
  const SurfacePoint touch = surface_.closest(tip);
  cost += touch.cost;
  if (touch.signed_distance > 0.0) return {};
  int node = -1;
  double nearest = std::numeric_limits<double>::infinity();
  for (const int corner : surface_.triangles()[at(touch.triangle)]) {
    if (!is_free(corner)) continue;
    ++cost.nodes;
    const double squared = (surface_.position(corner) - tip).squaredNorm();
    if (squared < nearest || (squared == nearest && corner < node)) {
      nearest = squared;
      node = corner;
    }
  }
  // A fixed part does not follow the tip; a free node elsewhere would be dragged to it.
  if (node < 0) return {};
  return {
      .contact = {.node = node, .offset = grip_offset(surface_.position(node), tip, touch.normal)},
      .event = ContactEvent::started};
}

Pass ContactSearch::proceed(const Touch& touch, std::span<const double> displacement,
                            SearchCost& cost) {
  const Eigen::Vector3d& tip = touch.tip;
  const Contact& present = touch.contact;
  const auto u = [&](int node) { return Eigen::Vector3d(&displacement[3 * at(node)]); };
  const std::span<const int> moving = patch(present.node);

  // Every node is judged at its undragged place, the contact node and those that it drags along
  // alike: with one measure for all, hysteresis is enough to keep contact from going to and fro.
  const double keeps = (undragged(present.node, u(present.node)) - tip).norm();
  int best = -1;
  double nearest = std::numeric_limits<double>::infinity();
  for (const int node : surface_.surface_nodes()) {
    if (!is_free(node)) continue;
    ++cost.nodes;
    const double distance = (undragged(node, u(node)) - tip).norm();
    if (distance < nearest) {
      best = node;
      nearest = distance;
    }
  }
  if (best < 0 || !(nearest < (1.0 - settings_.hysteresis) * keeps)) {
    return {.contact = present, .event = ContactEvent::held};
  }
  const bool prescribed = std::binary_search(moving.begin(), moving.end(), best);
  const Eigen::Vector3d place = prescribed ? undragged(best, u(best)) : surface_.position(best);
  return {.contact = {.node = best, .offset = grip_offset(place, tip, surface_.rest_normal(best))},
          .event = ContactEvent::slid};
}

void ContactSearch::require_touchable(const Contact& present) const {
  if (touchable(present.node)) return;
  throw InputError(
      fmt::format("contact at node {}, which is not a free node of the surface", present.node));
}

// Neither anchored nor any probe's.
bool ContactSearch::is_free(int node) const {
  return anchored_[at(node)] == 0 &&
         std::ranges::none_of(passes_, [node](const Pass& p) { return p.contact.node == node; });
}

bool ContactSearch::pulls(const Touch& touch) const {
  if (!touch.force.allFinite()) throw InputError("the contact force is not finite");
  return touch.force.dot(surface_.rest_normal(touch.contact.node)) > settings_.release_force;
}

bool ContactSearch::pulls_off(const Touch& touch) const {
  return prescribed_displacement(touch.contact, touch.tip)
             .dot(surface_.rest_normal(touch.contact.node)) > 0;
}

std::span<const Pass> ContactSearch::pass(std::span<const Touch> touches,
                                          std::span<const double> displacement) {
  return pass(touches, displacement, [this](const Touch& touch) { return pulls(touch); });
}

std::span<const Pass> ContactSearch::pass_without_force(std::span<const Touch> touches,
                                                        std::span<const double> displacement) {
  return pass(touches, displacement, [this](const Touch& touch) { return pulls_off(touch); });
}

std::span<const Pass> ContactSearch::keep(std::span<const Contact> present,
                                          std::span<const double> displacement) {
  surface_.update(displacement);
  pass_flops_ = surface_.update_flops();
  passes_.clear();
  for (const Contact& contact : present) {
    passes_.push_back({contact, contact.present() ? ContactEvent::held : ContactEvent::none});
  }
  return passes_;
}

SurfaceSpot ContactSearch::spot_of(const SurfacePoint& point) const {
  const std::array<int, 3>& corners = surface_.triangles()[at(point.triangle)];
  return {point.triangle,
          barycentric_weights(point.point, surface_.position(corners[0]),
                              surface_.position(corners[1]), surface_.position(corners[2]))};
}

std::span<const Pass> ContactSearch::nearest(std::span<const Touch> touches,
                                             std::span<const double> displacement) {
  surface_.update(displacement);
  SearchCost cost;
  passes_.clear();
  for (const Touch& touch : touches) {
    if (!touch.tip.allFinite()) throw InputError("the probe is not at a finite position");
    const SurfacePoint point = surface_.closest(touch.tip);
    cost += point.cost;
    passes_.push_back({.contact = {.spot = spot_of(point)}});
  }
  pass_flops_ = surface_.update_flops() + cost.flops();
  return passes_;
}

// A release takes a pass of its own: this U still has the surface at the tip, so that only the next
// one tells whether the tip touches the released body.
template <class Pulls>
std::span<const Pass> ContactSearch::pass(std::span<const Touch> touches,
                                          std::span<const double> displacement,
                                          const Pulls& pulls) {
  passes_.clear();
  for (const Touch& touch : touches) {
    if (!touch.tip.allFinite()) throw InputError("the probe is not at a finite position");
    passes_.push_back({touch.contact});
    if (!touch.contact.present()) continue;
    require_touchable(touch.contact);
    if (pulls(touch)) passes_.back().event = ContactEvent::released;
  }
  surface_.update(displacement);
  SearchCost cost;
  for (std::size_t i = 0; i < touches.size(); ++i) {
    Pass& pass = passes_[i];
    if (pass.event == ContactEvent::released) {
      pass.contact = Contact{};
    } else if (touches[i].contact.present()) {
      pass = proceed(touches[i], displacement, cost);
    } else {
      pass = start(touches[i].tip, cost);
    }
  }
  pass_flops_ = surface_.update_flops() + cost.flops();
  return passes_;
}

}  // namespace hvp::collision
