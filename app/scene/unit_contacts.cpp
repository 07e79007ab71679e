#include "app/scene/unit_contacts.h"

#include <algorithm>
#include <limits>

#include "models/fixed/system.h"
#include "models/host/reference_run.h"

namespace hvp::app {

namespace {

constexpr int kPlaces = 64;           // along the probe's way
constexpr std::size_t kContacts = 8;  // of them
constexpr double kTouch = 1e-3;       // m
// The most nodes; three factorisations of that size take about a second.
constexpr int kMostNodes = 4000;

struct Place {
  int node = -1;  // of the mesh
  double depth = 0;
};

// The free surface node nearest to the tip, and the tip's depth below it.
Place place_of(const collision::ContactSearch& contacts, const Eigen::Vector3d& tip) {
  Place place;
  double nearest = std::numeric_limits<double>::infinity();
  const collision::DeformedSurface& surface = contacts.surface();
  for (const int node : surface.surface_nodes()) {
    if (!contacts.touchable(node)) continue;
    const double distance = (surface.rest_position(node) - tip).norm();
    if (distance < nearest) {
      nearest = distance;
      place = {node, (surface.rest_position(node) - tip).dot(surface.rest_normal(node))};
    }
  }
  return place;
}

// Keeps the deepest touch of each node in the order of the way; without any touch, the nearest one.
std::vector<Place> touched(const Scene& scene, const plant::Trajectory& probe) {
  const std::int64_t end = probe.duration_ps();
  std::vector<Place> places;
  Place nearest;
  for (int i = 0; i <= kPlaces; ++i) {
    const Place place = place_of(scene.contacts(), probe.state_ps(end / kPlaces * i).position);
    if (nearest.node < 0 || place.depth > nearest.depth) nearest = place;
    if (place.depth <= 0) continue;
    const auto known =
        std::ranges::find_if(places, [&](const Place& p) { return p.node == place.node; });
    if (known == places.end()) {
      places.push_back(place);
    } else {
      known->depth = std::max(known->depth, place.depth);
    }
  }
  if (places.empty()) places.push_back({nearest.node, kTouch});
  if (places.size() <= kContacts) return places;
  std::vector<Place> few;
  for (std::size_t i = 0; i < kContacts; ++i) {
    few.push_back(places[i * (places.size() - 1) / (kContacts - 1)]);
  }
  return few;
}

}  // namespace

std::vector<host::UnitContact> unit_contacts(const Scene& scene) {
  std::vector<host::UnitContact> contacts;
  if (std::ranges::any_of(scene.body().load(), [](double f) { return f != 0; })) {
    contacts.emplace_back();
  }
  for (const plant::Trajectory& probe : scene.scenario().probes) {
    for (const Place& place : touched(scene, probe)) {
      host::UnitContact contact;
      for (const int node : scene.contacts().patch(place.node)) {
        contact.nodes.push_back(scene.body().active_index(node));
      }
      contact.displacement = -place.depth * scene.contacts().surface().rest_normal(place.node);
      contacts.push_back(std::move(contact));
    }
  }
  return contacts;
}

bool quick_to_factorise(const Scene& scene) {
  return scene.body().stiffness().block_rows() <= kMostNodes;
}

namespace {

// Of proxies and patches. Between nodes the compliance is about linear, so that the nodes have the
// extremes. A device is as heavy in each direction: what the body is stiffest in decides.
std::optional<double> proxy_stiffness(const Scene& scene) {
  std::optional<double> stiffest;
  for (std::size_t i = 0; i < scene.scenario().probes.size(); ++i) {
    for (const Place& place : touched(scene, scene.scenario().probes[i])) {
      stiffest = std::max(stiffest.value_or(0), scene.glide()->stiffness(i, place.node));
    }
  }
  return stiffest;
}

}  // namespace

std::optional<double> contact_stiffness(const Scene& scene) {
  if (scene.glide() != nullptr) return proxy_stiffness(scene);
  const fem::Body& body = scene.body();
  host::ReferenceRun run(body, std::nullopt, scene.scenario().budget.period_s, body.stiffness(),
                         body.stiffness());
  std::optional<double> stiffest;
  for (const host::UnitContact& contact : unit_contacts(scene)) {
    const double depth = contact.displacement.norm();
    if (!(depth > 0)) continue;
    // Loads press on a contact that is held in its place at rest, too.
    const std::vector<Eigen::Vector3d> rest(contact.nodes.size(), Eigen::Vector3d::Zero());
    run.step({contact.nodes, rest, {}, 0});
    const Eigen::Vector3d at_rest = run.force();
    const std::vector<Eigen::Vector3d> displacement(contact.nodes.size(), contact.displacement);
    run.step({contact.nodes, displacement, {}, 0});
    const double stiffness =
        std::abs((run.force() - at_rest).dot(contact.displacement)) / (depth * depth);
    stiffest = std::max(stiffest.value_or(0), stiffness);
  }
  return stiffest;
}

std::optional<host::RoundingEstimate> estimate_rounding(const Scene& scene) {
  if (!scene.has_board()) return std::nullopt;
  return estimate_rounding(scene, scene.computation());
}

std::optional<host::RoundingEstimate> estimate_rounding(const Scene& scene,
                                                        const host::FrameComputation& computation) {
  if (computation.timing_only()) return std::nullopt;
  if (!quick_to_factorise(scene)) return std::nullopt;
  return host::estimate_rounding(scene.body(), computation.matrix(),
                                 fixed::dequantise(computation.board().words()),
                                 unit_contacts(scene));
}

}  // namespace hvp::app
