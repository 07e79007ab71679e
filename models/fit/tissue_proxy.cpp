#include "models/fit/tissue_proxy.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "models/collision/probe_coupling.h"
#include "models/collision/surface_compliance.h"
#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::fit {
namespace {

// The body with E = 1 Pa.
fem::Body unit_body(const TissueBody& body, double poisson_ratio) {
  const fem::Material material{
      .young_modulus_pa = 1, .poisson_ratio = poisson_ratio, .density_kg_m3 = body.density_kg_m3};
  return {body.mesh, material, body.anchored, fem::AnchorTreatment::removed};
}

std::vector<bool> moving(const TissueBody& body) {
  std::vector<bool> moves(body.mesh.nodes.size(), true);
  for (const int node : body.anchored) moves[at(node)] = false;
  return moves;
}

Eigen::Matrix3d between_corners(collision::SurfaceCompliance& g, const ProxyPlaces::Place& place) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      sum += place.spot.weight[static_cast<Eigen::Index>(i)] *
             place.spot.weight[static_cast<Eigen::Index>(j)] *
             g.block(place.corners[i], place.corners[j]);
    }
  }
  return sum;
}

}  // namespace

ProxyPlaces::ProxyPlaces(const TissueBody& body)
    : body_(body), surface_(body.mesh), walk_(surface_, moving(body)) {}

std::size_t ProxyPlaces::add(const collision::SurfaceSpot& spot, double radius_m) {
  if (!spot.present() || at(spot.triangle) >= surface_.triangles().size() ||
      !walk_.touchable(spot.triangle)) {
    throw InputError("a proxy stands where the surface does not move; expected a free triangle");
  }
  // A proxy that sticks is in one place.
  if (!places_.empty() && places_.back().spot == spot && places_.back().radius_m == radius_m) {
    return places_.size() - 1;
  }
  places_.push_back(
      {spot, walk_.corners(spot.triangle), walk_.rest(spot), walk_.normal(spot), radius_m});
  return places_.size() - 1;
}

const ProxyPlaces::Answer* ProxyPlaces::answer(double poisson_ratio) const {
  if (const auto known = answers_.find(poisson_ratio); known != answers_.end()) {
    return &known->second;
  }
  if (poisson_ratio < 0) return nullptr;  // fem::Material has no such body
  const fem::Body body = unit_body(body_, poisson_ratio);
  std::optional<collision::SurfaceCompliance> statics;
  try {
    statics.emplace(body, body.stiffness(), surface_.surface_nodes());
  } catch (const InputError&) {
    return nullptr;
  }
  const collision::NodeCompliance nodes(body, surface_, *statics);
  std::map<double, collision::ProbeCoupling> couplings;  // by radius
  Answer answer;
  for (const Place& place : places_) {
    const auto& [radius, coupling] =
        *couplings
             .try_emplace(place.radius_m, nodes, place.radius_m,
                          collision::answer_of(body_.dynamics.has_value(), true))
             .first;
    answer.coupling.push_back(collision::coupling_compliance(
        *statics, place.corners, place.spot.weight, coupling.s0, coupling.of_node));
    answer.statics.push_back(between_corners(*statics, place) + answer.coupling.back());
  }
  return &answers_.emplace(poisson_ratio, std::move(answer)).first->second;
}

std::optional<ProxyPlaces::Answer> ProxyPlaces::slope(double poisson_ratio) const {
  constexpr double kShare = 1e-3;  // of the way to where a volume cannot change
  const double step = kShare * (0.5 - poisson_ratio);
  const double high = poisson_ratio + step;
  const double low = std::max(0.0, poisson_ratio - step);
  const Answer* above = answer(high);
  const Answer* below = answer(low);
  if (above == nullptr || below == nullptr) return std::nullopt;
  Answer slope;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    slope.coupling.emplace_back((above->coupling[i] - below->coupling[i]) / (high - low));
    slope.statics.emplace_back((above->statics[i] - below->statics[i]) / (high - low));
  }
  return slope;
}

ProxyTouch proxy_touch(ProxyPlaces& places, const ProxyPath& path, const Eigen::Vector3d& direction,
                       std::size_t samples) {
  if (!direction.allFinite() || !(direction.norm() > 0)) {
    throw InputError("the contact's direction has no length; expected a vector such as 0 0 -1");
  }
  if (path.tip.size() != samples || path.spot.size() != samples ||
      (!path.slides.empty() && path.slides.size() != samples)) {
    throw InputError(fmt::format("the proxy has {} tips and {} places; expected {} of each",
                                 path.tip.size(), path.spot.size(), samples));
  }
  if (!(path.friction > 0)) {
    throw InputError(
        fmt::format("the proxy's friction is {}; expected more than 0", path.friction));
  }
  ProxyTouch touch;
  touch.slides = path.slides.empty() ? std::vector<bool>(path.tip.size(), false) : path.slides;
  touch.friction = path.friction;
  touch.direction = direction.normalized();
  for (std::size_t i = 0; i < path.tip.size(); ++i) {
    if (!path.tip[i].allFinite()) throw InputError("the probe is not at a finite position");
    touch.place.push_back(places.add(path.spot[i], path.radius_m));
    touch.tip_from_x.emplace_back(path.tip[i] - places.place(touch.place.back()).rest);
  }
  return touch;
}

ForceOnCone put_on_cone(const Eigen::Vector3d& force, const Eigen::Vector3d& normal,
                        double friction) {
  const double pressing = -force.dot(normal);
  const Eigen::Vector3d tangential = force + pressing * normal;
  const double size = tangential.norm();
  if (!(size > 0) || !(pressing > 0)) return {force};
  const double share = friction * pressing / size;
  const Eigen::Vector3d along = tangential / size;
  ForceOnCone result;
  result.force = share * tangential - pressing * normal;
  const Eigen::Matrix3d nn = normal * normal.transpose();
  result.by_force = nn - friction * along * normal.transpose() +
                    share * (Eigen::Matrix3d::Identity() - nn - along * along.transpose());
  return result;
}

std::optional<TissueForce> static_proxy_force(const ProxyPlaces& places, const ProxyTouch& touch,
                                              const TissueValues& values, bool derivatives) {
  const ProxyPlaces::Answer* answer = places.answer(values.poisson_ratio);
  std::optional<ProxyPlaces::Answer> slope;
  if (derivatives) slope = places.slope(values.poisson_ratio);
  if (answer == nullptr || (derivatives && !slope)) return std::nullopt;
  TissueForce result;
  for (std::size_t i = 0; i < touch.place.size(); ++i) {
    const std::size_t place = touch.place[i];
    const auto lu = answer->statics[place].partialPivLu();
    const Eigen::Vector3d sticking = values.young_modulus * lu.solve(touch.tip_from_x[i]);
    ForceOnCone force{sticking};
    if (touch.slides[i]) force = put_on_cone(sticking, places.place(place).normal, touch.friction);
    result.force.push_back(touch.direction.dot(force.force));
    if (!derivatives) continue;
    result.by_young_modulus.push_back(result.force.back() / values.young_modulus);
    result.by_poisson_ratio.push_back(
        -touch.direction.dot(force.by_force * lu.solve(slope->statics[place] * sticking)));
  }
  return result;
}

}  // namespace hvp::fit
