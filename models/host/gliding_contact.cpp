#include "models/host/gliding_contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fem/direct_solver.h"
#include "models/index.h"

namespace hvp::host {

namespace {

// The forces of a body that is not linear are repeated until they change by no more than this
// share, or so often.
constexpr double kSettled = 1e-10;
constexpr int kMostRepetitions = 40;
// Of the force along the normal, what may drive a slide without a flag.
constexpr double kNoticeableSteepness = 0.05;

}  // namespace

GlideTables::GlideTables(const fem::Body& body, const sparse::BlockMatrix& system, bool is_dynamic,
                         bool linear, const collision::ContactSettings& contact,
                         std::span<const double> probe_radii)
    : surface(body.mesh()), statics(body, body.stiffness(), surface.surface_nodes()) {
  if (is_dynamic) dynamic.emplace(body, system, surface.surface_nodes());
  settings.friction = contact.friction;
  radii.assign(probe_radii.begin(), probe_radii.end());
  const collision::Answer answer = collision::answer_of(is_dynamic, linear);
  if (contact.kind == collision::ContactKind::patch) {
    if (!statics.tabulated()) {
      throw InputError("kind", fmt::format("patches need the compliances of all {} surface nodes "
                                           "in a table of {} MiB: expected fewer nodes, or "
                                           "\"proxy\"",
                                           surface.surface_nodes().size(),
                                           collision::SurfaceCompliance::kLargestTable >> 20));
    }
    const collision::SurfaceWalk walk(surface, collision::moving_nodes(body));
    for (const double radius : radii) {
      settings.patch.push_back(collision::patch_radius(surface, radius));
      collision::Footprints shapes(surface, walk, settings.patch.back());
      const collision::NodeCompliance nodes(body, surface, statics, &shapes);
      couple(nodes, radius, answer);
      settings.along.push_back(nodes.own);
      footprint_nodes_ = std::max(footprint_nodes_, shapes.most());
    }
  } else {
    const collision::NodeCompliance nodes(body, surface, statics);
    for (const double radius : radii) couple(nodes, radius, answer);
  }
  Eigen::AlignedBox3d box;
  for (const int node : surface.surface_nodes()) box.extend(surface.rest_position(node));
  half_extent = 0.5 * box.sizes().minCoeff();
  if (is_dynamic || !linear) return;
  free_displacement.resize(body.load().size());
  fem::DirectSolver(system).solve(body.load(), free_displacement);
}

void GlideTables::couple(const collision::NodeCompliance& nodes, double radius,
                         collision::Answer answer) {
  collision::ProbeCoupling coupling(nodes, radius, answer);
  settings.coupling.push_back(coupling.s0);
  settings.of_node.push_back(std::move(coupling.of_node));
  settings.excess.push_back(coupling.excess);
  least_.push_back(nodes.least);
}

double GlideTables::stiffness(std::size_t probe, int node) const {
  return 1 /
         (least_[probe][at(node)] + settings.coupling[probe] + settings.of_node[probe][at(node)]);
}

std::size_t GlideTables::bytes() const {
  return statics.bytes() + (dynamic ? dynamic->bytes() : 0);
}

std::int64_t GlideTables::solves() const {
  return statics.solves() + (dynamic ? dynamic->solves() : 0);
}

double GlideTables::set_up_operations() const {
  double operations = static_cast<double>(statics.solves()) * statics.solve_operations();
  if (dynamic) operations += static_cast<double>(dynamic->solves()) * dynamic->solve_operations();
  return operations;
}

GlidingContact::GlidingContact(const fem::Body& body, const GlideTables& tables, bool rendered)
    : tables_(tables),
      rendered_(rendered),
      statics_(tables.statics),
      dynamic_(tables.dynamic),
      proxy_(body, tables.surface, statics_, dynamic_ ? *dynamic_ : statics_, tables.settings),
      tips_(proxy_.size(), Eigen::Vector3d::Zero()),
      contacts_(proxy_.size()),
      forces_(proxy_.size(), Eigen::Vector3d::Zero()) {}

void GlidingContact::suggest(std::span<const collision::Contact> nearest) {
  suggested_ = true;
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    if (nearest[i].spot.present()) proxy_.suggest(i, nearest[i].spot);
  }
}

void GlidingContact::look(std::span<const Eigen::Vector3d> tips, std::span<const double> u) {
  solved_ = false;
  std::ranges::copy(tips, tips_.begin());
  if (!rendered_) proxy_.release_all();
  if (!suggested_) {
    for (std::size_t i = 0; i < tips.size(); ++i) {
      if (!contacts_[i].present()) proxy_.suggest(i, proxy_.walk().nearest_at_rest(tips[i]));
    }
  }
  proxy_.look(tips_, u);
  look_operations_ = proxy_.operations();
}

void GlidingContact::solve(std::span<const double> u1) {
  if (!rendered_) {
    proxy_.press_nowhere();
  } else if (needs_solution()) {
    proxy_.solve(tips_, u1);
  } else {
    proxy_.solve_free(tips_, tables_.free_displacement);
  }
  solved_ = true;
  solve_operations_ = proxy_.operations();
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const collision::ProxyContact::Probe& probe = proxy_.probes()[i];
    forces_[i] = probe.force;
    contacts_[i] = {};
    if (!probe.spot.present()) continue;
    Eigen::Index nearest = 0;
    probe.spot.weight.maxCoeff(&nearest);
    contacts_[i].node =
        tables_.surface.triangles()[at(probe.spot.triangle)][static_cast<std::size_t>(nearest)];
    contacts_[i].spot = probe.spot;
  }
}

bool GlidingContact::changes() const {
  return !placed_ || !proxy_.loads().empty() || !proxy_.applied().empty();
}

double GlideTables::typical_operations() const {
  return collision::ProxyContact::typical_operations(radii.size(), footprint_nodes_);
}

// Two ends in one place: each has a coupling of its own, and together they are too stiff.
bool GlidingContact::overlap() const {
  const auto probes = proxy_.probes();
  for (std::size_t i = 0; i < probes.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!probes[i].spot.present() || !probes[j].spot.present()) continue;
      const Eigen::Vector3d apart =
          proxy_.walk().rest(probes[i].spot) - proxy_.walk().rest(probes[j].spot);
      if (apart.norm() < tables_.radii[i] + tables_.radii[j]) return true;
    }
  }
  return false;
}

stability::Flags GlidingContact::flags() const {
  stability::Flags flags;
  if (overlap()) flags.raise(stability::Flag::contact_doubtful);
  for (std::size_t i = 0; i < tables_.radii.size(); ++i) {
    const collision::ProxyContact::Probe& probe = proxy_.probes()[i];
    if (!probe.spot.present()) continue;
    // The coupling is that of a small indentation, which no strain of an element shows.
    const double diameter = 2 * tables_.radii[i];
    if (diameter > 0 && probe.gap.norm() > diameter) {
      flags.raise(stability::Flag::contact_doubtful);
    }
    // On the way to a stiffer place a hand gets back more than it gave, unless friction takes it.
    const bool makes_energy =
        probe.sliding && probe.steepness - tables_.settings.friction > kNoticeableSteepness;
    const bool at_rim = probe.at_rim || proxy_.walk().near_crease(probe.spot, tables_.radii[i]);
    if (at_rim || makes_energy) flags.raise(stability::Flag::proxy_at_rim);
    if (probe.off_cone || probe.depth > tables_.half_extent)
      flags.raise(stability::Flag::contact_doubtful);
  }
  return flags;
}

void GlidingContact::describe(std::size_t probe, collision::Touch& touch) const {
  const collision::ProxyContact::Probe& state = proxy_.probes()[probe];
  touch.contact = contacts_[probe];
  touch.force = forces_[probe];
  touch.gap = state.gap.norm();
  touch.unresolved = state.unresolved;
  touch.depth = state.depth;
  touch.slides = state.sliding;
  if (!state.spot.present()) return;
  touch.foot = proxy_.walk().rest(state.spot);
  touch.normal = state.normal;
}

// The proxy stands between its place without contact and the tip.
double GlidingContact::way() const {
  double way = 0;
  for (const collision::ProxyContact::Probe& probe : proxy_.probes()) {
    if (probe.spot.present()) way = std::max(way, probe.pressed);
  }
  return way;
}

void GlidingContact::apply() {
  placed_ = true;
  proxy_.apply();
}

GlidingReference::GlidingReference(std::unique_ptr<fem::ReferenceModel> inner,
                                   std::unique_ptr<GlidingContact> contact)
    : inner_(std::move(inner)), contact_(std::move(contact)) {}

void GlidingReference::solve(const fem::Hold& hold) {
  contact_->look(hold.tips, inner_->displacement());
  inner_->solve(contact_->hold());
  contact_->solve(inner_->displacement());
  for (int i = 0; i < kMostRepetitions; ++i) {
    if (!contact_->changes()) return;
    inner_->solve(contact_->hold());
    contact_->apply();
    if (inner_->linear()) return;
    before_.assign(contact_->forces().begin(), contact_->forces().end());
    contact_->solve(inner_->displacement());
    double change = 0;
    double largest = 0;
    for (std::size_t k = 0; k < before_.size(); ++k) {
      change = std::max(change, (contact_->forces()[k] - before_[k]).norm());
      largest = std::max(largest, contact_->forces()[k].norm());
    }
    if (change <= kSettled * largest) return;
  }
  ++unsettled_;
}

}  // namespace hvp::host
