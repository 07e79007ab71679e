#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "models/collision/contact.h"
#include "models/collision/deformed_surface.h"
#include "models/collision/probe_coupling.h"
#include "models/collision/proxy_contact.h"
#include "models/collision/surface_compliance.h"
#include "models/fem/body.h"
#include "models/fem/hold.h"
#include "models/fem/reference_model.h"
#include "models/sparse/block_matrix.h"
#include "models/stability/flag.h"

namespace hvp::host {

// What contact by a proxy knows of a body before the first frame: compliances of its surface, and
// where it is without contact.
struct GlideTables {
  // `system` is the matrix of every frame, K or Â. `linear`: the body's forces are A·u. The radius
  // of each probe is that of its end, m. Throws InputError for a matrix that is not positive
  // definite, and for patches on a body whose compliances do not stand in a table.
  GlideTables(const fem::Body& body, const sparse::BlockMatrix& system, bool dynamic, bool linear,
              const collision::ContactSettings& contact, std::span<const double> probe_radii);

  collision::DeformedSurface surface;                   // stays at rest
  collision::SurfaceCompliance statics;                 // of K
  std::optional<collision::SurfaceCompliance> dynamic;  // of Â; absent for a static body
  collision::ProxySettings settings;
  std::vector<double> radii;  // of the probes' ends, m
  // The displacement without contact of a static linear body, m; empty otherwise.
  std::vector<double> free_displacement;

  double half_extent = 0;  // of the body at rest, along the axis in which it is thinnest, m

  // The largest eigenvalue of (C·G·Cᵀ + S)⁻¹ with X at a surface node that moves, N/m: what a tip
  // feels of a body at rest in the direction in which it is stiffest.
  double stiffness(std::size_t probe, int node) const;

  std::size_t bytes() const;
  std::int64_t solves() const;
  // The additions and multiplications of those solves.
  double set_up_operations() const;
  // What the probes' forces take in a frame in which they slide.
  double typical_operations() const;

 private:
  void couple(const collision::NodeCompliance& nodes, double radius, collision::Answer answer);

  std::size_t footprint_nodes_ = 3;         // of a probe, at the most
  std::vector<std::vector<double>> least_;  // eigenvalue of C·G·Cᵀ of each probe at each mesh node
};

// The contact of the frames by proxies, kind = "proxy", in a run, in a reference or in a replay:
// each has its own, and finds the contact by itself from the tips.
//
//   look(tips, u);  the body holds hold();  …A·u1 = load is solved, where needs_solution()…
//   solve(u1);      …the forces go out; the body holds hold(), and A·u = load is solved…
//   apply();        // or the body holds applied(), where that failed
class GlidingContact {
 public:
  // Keeps references. `rendered`: false where numbers are not computed; contact is then where the
  // tip is inside the body at rest.
  GlidingContact(const fem::Body& body, const GlideTables& tables, bool rendered = true);
  GlidingContact(const GlidingContact&) = delete;
  GlidingContact& operator=(const GlidingContact&) = delete;

  // False for a static body of linear elasticity: the load without contact does not change, so
  // that its forces do not wait for a solve.
  bool needs_solution() const { return tables_.free_displacement.empty(); }
  // Takes the places from which contact is sought; without it, the nearest ones at rest.
  void suggest(std::span<const collision::Contact> nearest);
  void look(std::span<const Eigen::Vector3d> tips, std::span<const double> u);
  void solve(std::span<const double> u1);
  void apply();

  // The loads with which the system is solved next, and those with which it was solved last.
  fem::Hold hold() const { return fem::Hold::of_loads(next_loads(), tips_); }
  fem::Hold applied() const { return fem::Hold::of_loads(proxy_.applied(), tips_); }
  // False where the second solve of a frame would change nothing: there was no contact, and there
  // is none.
  bool changes() const;

  // How far the forces move the body where they press, at the most, m.
  double way() const;

  // One for each probe, after solve().
  std::span<const collision::Contact> contacts() const { return contacts_; }
  std::span<const Eigen::Vector3d> forces() const { return forces_; }  // on the body, N
  std::span<const collision::ProxyContact::Probe> probes() const { return proxy_.probes(); }
  // What solve() found that a proxy is not meant for.
  stability::Flags flags() const;
  // The touch of a probe, its tip left as it is.
  void describe(std::size_t probe, collision::Touch& touch) const;

  // The additions and multiplications of the last look() and of the last solve().
  double look_operations() const { return look_operations_; }
  double solve_operations() const { return solve_operations_; }

 private:
  std::span<const fem::ContactLoad> next_loads() const {
    return solved_ ? proxy_.loads() : proxy_.applied();
  }

  bool overlap() const;

  const GlideTables& tables_;
  bool rendered_;
  collision::SurfaceCompliance statics_;
  std::optional<collision::SurfaceCompliance> dynamic_;
  collision::ProxyContact proxy_;
  std::vector<Eigen::Vector3d> tips_;
  std::vector<collision::Contact> contacts_;
  std::vector<Eigen::Vector3d> forces_;
  bool solved_ = false;  // in this frame
  bool placed_ = false;  // the body has been solved for once
  bool suggested_ = false;
  double look_operations_ = 0;
  double solve_operations_ = 0;
};

// A reference whose contact is a proxy of its own: the inner one solves for the body.
class GlidingReference final : public fem::ReferenceModel {
 public:
  // Where the body is not linear the forces are those with which it is in equilibrium, found by
  // repetition.
  GlidingReference(std::unique_ptr<fem::ReferenceModel> inner,
                   std::unique_ptr<GlidingContact> contact);

  void solve(const fem::Hold& hold) override;
  void advance() override { inner_->advance(); }
  bool linear() const override { return inner_->linear(); }
  std::span<const double> displacement() const override { return inner_->displacement(); }
  std::span<const double> velocity() const override { return inner_->velocity(); }
  std::span<const Eigen::Vector3d> forces() const override { return contact_->forces(); }
  std::int64_t unsolved() const override { return inner_->unsolved() + unsettled_; }
  std::int64_t overflown() const override { return inner_->overflown(); }
  std::int64_t indefinite() const override { return inner_->indefinite(); }

 private:
  std::unique_ptr<fem::ReferenceModel> inner_;
  std::unique_ptr<GlidingContact> contact_;
  std::vector<Eigen::Vector3d> before_;
  std::int64_t unsettled_ = 0;  // frames whose forces did not settle
};

}  // namespace hvp::host
