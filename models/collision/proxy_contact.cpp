#include "models/collision/proxy_contact.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "models/collision/probe_coupling.h"
#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::collision {

namespace {

// Additions and multiplications: a block times its weights, added to another one; a block times a
// force; a triangle that was tried (kTriangleFlops has the distance, nine more its place).
constexpr double kBlock = 19;
constexpr double kProduct = 15;
constexpr double kTried = kTriangleFlops + 9;
// Normal, cone and step of a probe.
constexpr double kCone = 120;
// What nodes add to a coupling, and how their compliances change over a triangle.
constexpr double kOfNodes = 6;
constexpr double kSteepness = 150;

// Solves the n × n system m·x = d in place by Gauss' elimination; m is symmetric and positive
// definite, so that no pivot is sought.
void solve_dense(std::span<double> m, std::span<double> d, std::size_t n) {
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = m[n * i + k] / m[n * k + k];
      for (std::size_t j = k + 1; j < n; ++j) m[n * i + j] -= factor * m[n * k + j];
      d[i] -= factor * d[k];
    }
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t j = i + 1; j < n; ++j) d[i] -= m[n * i + j] * d[j];
    d[i] /= m[n * i + i];
  }
}

}  // namespace

ProxyContact::ProxyContact(const fem::Body& body, const DeformedSurface& surface,
                           SurfaceCompliance& statics, SurfaceCompliance& system,
                           ProxySettings settings)
    : body_(body),
      statics_(statics),
      system_(system),
      settings_(std::move(settings)),
      walk_(surface, moving_nodes(body)),
      sought_(settings_.coupling.size()),
      probes_(settings_.coupling.size()) {
  const std::size_t probes = probes_.size();
  settings_.patch.resize(probes);
  settings_.along.resize(probes);
  std::size_t nodes = 0;
  for (std::size_t i = 0; i < probes; ++i) {
    shapes_.emplace_back(surface, walk_, settings_.patch[i]);
    footprints_.emplace_back();
    footprints_[i].nodes.reserve(shapes_[i].most());
    footprints_[i].weight.reserve(shapes_[i].most());
    nodes += shapes_[i].most();
  }
  loads_.reserve(nodes);
  applied_.reserve(nodes);
  present_.reserve(probes);
  settings_.excess.resize(probes);
  settings_.of_node.resize(probes);
  drag_.resize(probes);
  own_.resize(probes);
  m_.resize(9 * probes * probes);
  d_.resize(3 * probes);
}

Eigen::Vector3d ProxyContact::displacement(std::span<const double> u, int node) const {
  const int active = body_.active_index(node);
  if (active < 0) return body_.held_displacement(node);
  const double* at_node = &u[3 * at(active)];
  return {at_node[0], at_node[1], at_node[2]};
}

void ProxyContact::look(std::span<const Eigen::Vector3d> tips, std::span<const double> u) {
  operations_ = 0;
  const auto of_node = [&](int node) { return displacement(u, node); };
  for (std::size_t i = 0; i < probes_.size(); ++i) {
    if (!tips[i].allFinite()) throw InputError("the probe is not at a finite position");
    Probe& probe = probes_[i];
    if (probe.spot.present()) {
      // Beyond an edge the tip may be behind the plane of the proxy's face and in the air. The
      // surface that was pressed follows a tip that lifts: between that and rest λ decides.
      SearchCost cost;
      if (walk_.outside(tips[i], of_node, cost) > 0) leave(probe);
      operations_ += cost.flops() + kCone;
    }
    if (probe.spot.present() || !sought_[i].present()) continue;
    long tried = 0;
    sought_[i] = walk_.nearest(tips[i], sought_[i], of_node, tried);
    operations_ += kTried * static_cast<double>(tried) + kCone;
    if (!walk_.touchable(sought_[i].triangle)) continue;
    const Eigen::Vector3d place = walk_.rest(sought_[i]) + walk_.displaced(sought_[i], of_node);
    if ((tips[i] - place).dot(walk_.normal(sought_[i])) > 0) continue;
    // Over an edge the nearest face may be one whose plane the tip is behind, however far away.
    SearchCost cost;
    const bool is_outside = walk_.outside(tips[i], of_node, cost) > 0;
    operations_ += cost.flops();
    if (is_outside) continue;
    probe = {};
    probe.spot = sought_[i];
  }
}

std::size_t ProxyContact::most_nodes() const {
  std::size_t most = 0;
  for (const Footprints& shape : shapes_) most = std::max(most, shape.most());
  return most;
}

// True where a patch has a node that does not move.
bool ProxyContact::over_anchor(std::size_t probe) const {
  return settings_.patch[probe] > 0 &&
         std::ranges::any_of(footprints_[probe].nodes,
                             [this](int node) { return !system_.has(node); });
}

void ProxyContact::find_footprint(std::size_t probe) {
  shapes_[probe].find(probes_[probe].spot, footprints_[probe]);
  operations_ += shapes_[probe].operations();
}

Eigen::Vector3d ProxyContact::displaced(const Footprint& footprint,
                                        std::span<const double> u) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < footprint.nodes.size(); ++i) {
    sum += footprint.weight[i] * displacement(u, footprint.nodes[i]);
  }
  return sum;
}

Eigen::Matrix3d ProxyContact::between(SurfaceCompliance& of, const Footprint& a,
                                      const Footprint& b) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    for (std::size_t j = 0; j < b.nodes.size(); ++j) {
      sum += a.weight[i] * b.weight[j] * of.block(a.nodes[i], b.nodes[j]);
    }
  }
  operations_ += kBlock * static_cast<double>(a.nodes.size() * b.nodes.size());
  return sum;
}

Eigen::Matrix3d ProxyContact::coupling(const SurfaceSpot& spot, std::size_t probe) {
  const std::vector<double>& of_node = settings_.of_node[probe];
  if (!of_node.empty()) operations_ += kOfNodes;
  if (settings_.patch[probe] > 0) {
    // A patch is even by its size.
    return own_coupling(walk_.corners(spot.triangle), spot.weight, settings_.coupling[probe],
                        of_node) *
           Eigen::Matrix3d::Identity();
  }
  operations_ += 3 * (kBlock + 27);
  return coupling_compliance(statics_, walk_.corners(spot.triangle), spot.weight,
                             settings_.coupling[probe], of_node);
}

// Statics along the normal are linear over a triangle, b_i·(n·G_ii·n + s_i), and a patch's about
// so.
double ProxyContact::steepness(const Probe& probe, std::size_t of) {
  const std::array<int, 3>& t = walk_.corners(probe.spot.triangle);
  std::array<Eigen::Vector3d, 3> x;
  std::array<double, 3> total{};
  for (std::size_t i = 0; i < 3; ++i) {
    x[i] = walk_.rest_position(t[i]);
    total[i] = settings_.along[of].empty()
                   ? probe.normal.dot(statics_.block(t[i], t[i]) * probe.normal)
                   : settings_.along[of][at(t[i])];
    if (!settings_.of_node[of].empty()) total[i] += settings_.of_node[of][at(t[i])];
  }
  // The gradient within the plane: n × (edge opposite to each corner), over twice the area.
  const Eigen::Vector3d across = (x[1] - x[0]).cross(x[2] - x[0]);
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    gradient += total[i] * across.cross(x[(i + 2) % 3] - x[(i + 1) % 3]);
  }
  operations_ += kSteepness;
  return -0.5 * probe.force.dot(probe.normal) * gradient.norm() / across.squaredNorm();
}

void ProxyContact::solve(std::span<const Eigen::Vector3d> tips, std::span<const double> u1) {
  solve(tips, u1, applied_);
}

void ProxyContact::solve_free(std::span<const Eigen::Vector3d> tips,
                              std::span<const double> u_free) {
  solve(tips, u_free, {});
}

void ProxyContact::solve(std::span<const Eigen::Vector3d> tips, std::span<const double> u,
                         std::span<const fem::ContactLoad> in_u) {
  const auto solved_before = system_.solves() + (&statics_ == &system_ ? 0 : statics_.solves());
  operations_ = 0;
  tips_ = tips;
  u_ = u;
  in_u_ = in_u;
  for (std::size_t i = 0; i < probes_.size(); ++i) {
    if (!tips[i].allFinite()) throw InputError("the probe is not at a finite position");
    Probe& probe = probes_[i];
    probe = {.spot = probe.spot, .strongest = probe.strongest};
  }
  // A contact that has ended leaves the others with other forces.
  for (int step = 0;; ++step) {
    do {
      solve_for_forces();
    } while (release_one());
    if (!slide(step < settings_.steps)) break;
  }
  for (const std::size_t i : present_) {
    Probe& probe = probes_[i];
    const Eigen::Vector3d moved = between(system_, footprints_[i], footprints_[i]) * probe.force;
    probe.pressed = moved.norm();
    probe.gap = coupling(probe.spot, i) * probe.force;
    probe.unresolved = settings_.excess[i] * -probe.force.dot(probe.normal);
    probe.depth = (walk_.rest(probe.spot) - tips[i]).dot(probe.normal);
    probe.at_rim =
        probe.at_rim || walk_.at_anchor(probe.spot) || footprints_[i].at_rim || over_anchor(i);
    probe.steepness = steepness(probe, i);
  }
  form_loads();
  const auto solves =
      system_.solves() + (&statics_ == &system_ ? 0 : statics_.solves()) - solved_before;
  operations_ += static_cast<double>(solves) * system_.solve_operations();
}

// λ of all probes in contact where they are now.
void ProxyContact::solve_for_forces() {
  present_.clear();
  for (std::size_t i = 0; i < probes_.size(); ++i) {
    if (!probes_[i].spot.present()) continue;
    present_.push_back(i);
    find_footprint(i);
  }
  const std::size_t n = 3 * present_.size();
  for (std::size_t p = 0; p < present_.size(); ++p) {
    const SurfaceSpot& spot = probes_[present_[p]].spot;
    const Footprint& footprint = footprints_[present_[p]];
    Eigen::Vector3d apart = tips_[present_[p]] - walk_.rest(spot) - displaced(footprint, u_);
    for (const fem::ContactLoad& load : in_u_) {
      const int other = body_.node_of_active()[at(load.node)];
      for (std::size_t i = 0; i < footprint.nodes.size(); ++i) {
        apart += footprint.weight[i] * (system_.block(footprint.nodes[i], other) * load.force);
      }
      operations_ += (kProduct + 6) * static_cast<double>(footprint.nodes.size());
    }
    for (int r = 0; r < 3; ++r) d_[3 * p + at(r)] = apart[r];
    for (std::size_t q = 0; q <= p; ++q) {
      Eigen::Matrix3d block = between(system_, footprint, footprints_[present_[q]]);
      if (q == p) {
        block += coupling(spot, present_[p]);
        own_[p] = block;
      }
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) {
          m_[n * (3 * p + at(r)) + 3 * q + at(c)] = block(r, c);
          m_[n * (3 * q + at(c)) + 3 * p + at(r)] = block(r, c);
        }
      }
    }
    operations_ += 30;
  }
  solve_dense({m_.data(), n * n}, {d_.data(), n}, n);
  const auto rows = static_cast<double>(n);
  operations_ += rows * rows * (2 * rows / 3 + 2);
  for (std::size_t p = 0; p < present_.size(); ++p) {
    Probe& probe = probes_[present_[p]];
    probe.force = {d_[3 * p], d_[3 * p + 1], d_[3 * p + 2]};
    probe.normal = walk_.normal(probe.spot);
  }
}

double ProxyContact::typical_operations(std::size_t probes, std::size_t nodes) {
  const auto p = static_cast<double>(probes);
  const auto of_one = static_cast<double>(nodes);
  const double rows = 3 * p;
  const double solve = p * (p + 1) / 2 * of_one * of_one * kBlock +
                       p * (3 * (kBlock + 27) + kOfNodes + 30) +
                       of_one * p * p * of_one * (kProduct + 6) + rows * rows * (2 * rows / 3 + 2);
  return 2 * (solve + kCone * p) +
         p * (of_one * of_one * kBlock + 3 * (kBlock + 27) + kOfNodes + kSteepness + kCone + 9);
}

void ProxyContact::leave(Probe& probe) {
  // The surface is sought again from where it was left.
  sought_[static_cast<std::size_t>(&probe - probes_.data())] = probe.spot;
  probe = {};
}

// The tip that pulls the most leaves.
bool ProxyContact::release_one() {
  Probe* leaves = nullptr;
  double most = 0;
  for (const std::size_t i : present_) {
    const double pull = probes_[i].force.dot(probes_[i].normal);
    if (pull >= 0 && (leaves == nullptr || pull > most)) {
      leaves = &probes_[i];
      most = pull;
    }
  }
  if (leaves == nullptr) return false;
  leave(*leaves);
  return true;
}

// Moves each proxy whose force is outside of its cone by what brings the force onto it, or, where
// it may not move any more, leaves out what is outside. True where one has moved.
bool ProxyContact::slide(bool move) {
  bool moved = false;
  for (std::size_t p = 0; p < present_.size(); ++p) {
    Probe& probe = probes_[present_[p]];
    operations_ += kCone;
    const double normal = -probe.force.dot(probe.normal);
    const Eigen::Vector3d tangential = probe.force + normal * probe.normal;
    const double size = tangential.norm();
    const double limit = settings_.friction * normal;
    probe.strongest = std::max(probe.strongest, normal);
    // M changes on the way, so that X may have gone too far and leaves a force within the cone.
    Eigen::Vector3d& drag = drag_[present_[p]];
    const bool outside = size > limit;
    const bool too_far = !outside && probe.sliding && tangential.dot(drag) > 0;
    if (!outside && !too_far) continue;
    if (!probe.sliding) drag = tangential;
    probe.sliding = true;
    const Eigen::Vector3d on_cone = (limit / size) * tangential;
    if (move && (outside || limit - size > kOnCone * limit)) {
      const SurfaceWalk::Step step = walk_.go(probe.spot, own_[p] * (tangential - on_cone));
      probe.at_rim = probe.at_rim || step.stopped || step.creased;
      operations_ += kCone * step.triangles;
      if (!(step.spot == probe.spot)) {
        probe.spot = step.spot;
        moved = true;
        continue;
      }
    }
    probe.off_cone = std::abs(size - limit) > kOnCone * probe.strongest;
    probe.force = on_cone - normal * probe.normal;
  }
  return moved;
}

void ProxyContact::form_loads() {
  loads_.clear();
  for (const std::size_t i : present_) {
    const Footprint& footprint = footprints_[i];
    for (std::size_t k = 0; k < footprint.nodes.size(); ++k) {
      if (!system_.has(footprint.nodes[k])) continue;
      loads_.push_back({body_.active_index(footprint.nodes[k]),
                        footprint.weight[k] * probes_[i].force, static_cast<int>(i)});
    }
    operations_ += 3 * static_cast<double>(footprint.nodes.size());
  }
}

void ProxyContact::press_nowhere() {
  present_.clear();
  for (std::size_t i = 0; i < probes_.size(); ++i) {
    if (!probes_[i].spot.present()) continue;
    probes_[i].normal = walk_.normal(probes_[i].spot);
    present_.push_back(i);
  }
  operations_ = 0;
  double blocks = 0;
  for (const std::size_t i : present_) {
    find_footprint(i);
    for (const std::size_t j : present_) {
      blocks += static_cast<double>(footprints_[i].nodes.size() * footprints_[j].nodes.size());
    }
  }
  form_loads();
  const auto n = 3 * static_cast<double>(present_.size());
  operations_ += blocks * kBlock + n * n * (2 * n / 3 + 2) + 2 * kCone * n / 3;
}

void ProxyContact::apply() { applied_.assign(loads_.begin(), loads_.end()); }

void ProxyContact::release_all() {
  for (Probe& probe : probes_) {
    if (probe.spot.present()) leave(probe);
  }
}

Eigen::MatrixXd ProxyContact::compliance() {
  std::vector<std::size_t> present;
  for (std::size_t i = 0; i < probes_.size(); ++i) {
    if (!probes_[i].spot.present()) continue;
    present.push_back(i);
    find_footprint(i);
  }
  Eigen::MatrixXd m(3 * static_cast<Eigen::Index>(present.size()),
                    3 * static_cast<Eigen::Index>(present.size()));
  for (std::size_t p = 0; p < present.size(); ++p) {
    for (std::size_t q = 0; q < present.size(); ++q) {
      const SurfaceSpot& spot = probes_[present[p]].spot;
      Eigen::Matrix3d block = between(system_, footprints_[present[p]], footprints_[present[q]]);
      if (p == q) block += coupling(spot, present[p]);
      m.block<3, 3>(3 * static_cast<Eigen::Index>(p), 3 * static_cast<Eigen::Index>(q)) = block;
    }
  }
  return m;
}

}  // namespace hvp::collision
