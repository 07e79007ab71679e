#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "models/collision/contact.h"
#include "models/collision/deformed_surface.h"
#include "models/collision/surface_walk.h"
#include "models/fem/body.h"
#include "models/fit/tissue_response.h"
#include "models/fit/tissue_system.h"

namespace hvp::fit {

// The touch of a body by a proxy (models/collision/proxy_contact.h), sample by sample.
struct ProxyPath {
  double radius_m = 0;                            // of the probe's end
  double friction = 0.3;                          // Coulomb's coefficient, above zero
  std::vector<Eigen::Vector3d> tip = {};          // m
  std::vector<collision::SurfaceSpot> spot = {};  // X, on a triangle of TissueBody::mesh.boundary
  std::vector<bool> slides = {};  // the force is on Coulomb's cone; empty: it sticks
};

// The places on a body's surface at which proxies press, and how the body answers there. With E
// alone all of it changes in proportion to 1/E: G = K⁻¹, and of the coupling also what is of the
// probe, 0.766/(E*·r). So it is found for E = 1 Pa, once for each ν. The coupling depends on the
// compliance of every surface node (collision::ProbeCoupling), which takes three solves a node.
//
// One thread at a time, as what was found is remembered.
class ProxyPlaces {
 public:
  // Throws InputError for what fem::Body and collision::DeformedSurface refuse.
  explicit ProxyPlaces(const TissueBody& body);

  struct Place {
    collision::SurfaceSpot spot;
    std::array<int, 3> corners{};                      // mesh nodes
    Eigen::Vector3d rest = Eigen::Vector3d::Zero();    // X, m
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // outward, length one
    double radius_m = 0;
  };
  // The number of the place, which may have been added before. To be called before answer().
  // Throws InputError for a triangle that the mesh does not have or none of whose corners moves.
  std::size_t add(const collision::SurfaceSpot& spot, double radius_m);
  const Place& place(std::size_t number) const { return places_[number]; }

  // Of each place, m/N for E = 1 Pa.
  struct Answer {
    std::vector<Eigen::Matrix3d> coupling;  // S
    std::vector<Eigen::Matrix3d> statics;   // C·G·Cᵀ + S
  };
  // Null where K is not positive definite to double precision, and for a ν below zero.
  const Answer* answer(double poisson_ratio) const;
  // Its derivative by ν, from central differences, at zero from one side: the coupling has kinks,
  // where a node's floor takes over. Empty where answer() is null.
  std::optional<Answer> slope(double poisson_ratio) const;

  const collision::SurfaceWalk& walk() const { return walk_; }
  const collision::DeformedSurface& surface() const { return surface_; }

 private:
  const TissueBody& body_;
  collision::DeformedSurface surface_;
  collision::SurfaceWalk walk_;
  std::vector<Place> places_;
  mutable std::map<double, Answer> answers_;  // by ν
};

// A path in the form that the model takes.
struct ProxyTouch {
  std::vector<std::size_t> place;           // of ProxyPlaces, of each sample
  std::vector<Eigen::Vector3d> tip_from_x;  // tip − X, m
  std::vector<bool> slides;
  double friction = 0;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  // of the force that is logged, length one
};
// Throws InputError for lists that have not as many `samples`, tips that are not finite, a friction
// that is not above zero, and as ProxyPlaces::add().
ProxyTouch proxy_touch(ProxyPlaces& places, const ProxyPath& path, const Eigen::Vector3d& direction,
                       std::size_t samples);

// A force on Coulomb's cone about the normal, and its derivative by the force that was put there.
struct ForceOnCone {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N
  Eigen::Matrix3d by_force = Eigen::Matrix3d::Identity();
};
ForceOnCone put_on_cone(const Eigen::Vector3d& force, const Eigen::Vector3d& normal,
                        double friction);

// The force of a static body, λ = (C·G·Cᵀ + S)⁻¹·(tip − X) of each sample, put onto the cone where
// the proxy slides, along the touch's direction. Empty where K is not positive definite to double
// precision.
std::optional<TissueForce> static_proxy_force(const ProxyPlaces& places, const ProxyTouch& touch,
                                              const TissueValues& values, bool derivatives);

// The force of a body with inertia, which begins at rest:
//   M·ü + C·u̇ + K·u = Cᵀλ,   λ = (C·Â⁻¹·Cᵀ + S)⁻¹·(tip − X − C·u_free)
// by Newmark's rule, u_free being the solution without this step's λ. The derivative is that of the
// discrete solution: s = ∂u/∂θ obeys the same equation with −(∂C/∂θ·u̇ + ∂K/∂θ·u) and ∂λ/∂θ, and
// C·s + S·∂λ/∂θ = −∂S/∂θ·λ. Where the proxy slides the part of ∂λ that comes from the difference to
// the cone, a hundredth of the friction, is left out. `system` is the body without a contact.
// Empty where K or Â is not positive definite to double precision.
std::optional<TissueForce> dynamic_proxy_force(const TissueSystem& system, const TissueBody& body,
                                               const ProxyPlaces& places, const ProxyTouch& touch,
                                               const TissueValues& values, bool derivatives);

}  // namespace hvp::fit
