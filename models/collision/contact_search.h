#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "models/collision/contact.h"
#include "models/collision/deformed_surface.h"

namespace hvp::collision {

enum class ContactEvent {
  none,      // no contact before, none now
  started,   // the tip reached the body
  held,      // the same node
  slid,      // another node took over
  released,  // contact ended, because the tip pulled
};

// The result of a collision pass for one probe.
struct Pass {
  Contact contact;
  ContactEvent event = ContactEvent::none;
};

// The collision half of the 33 Hz process (thesis §6.2.3): each collision pass decides for each
// probe which node is in contact. No two probes have the same node. docs/collision.md states the
// rules and their reasons. The result is a function of the arguments alone; only the cost is
// remembered from one pass to the next.
class ContactSearch {
 public:
  // `anchored` is the nodes that are fixed and cannot be touched, in any order. Throws InputError
  // as DeformedSurface does; for an anchored node that the mesh does not have; where no surface
  // node is free; for a patch radius that puts more than four million entries into the patches.
  ContactSearch(const mesh::TetMesh& mesh, std::span<const int> anchored,
                const ContactSettings& settings);

  // `touches` is the probes' centres, the contacts that `displacement` was computed with, and the
  // forces at them (thesis Fig. 3.5c; a patch's sum), which are ignored without a contact.
  // `displacement` is the last known U: x, y, z of every node, m. Returns a Pass for each probe,
  // valid until the next call. Throws InputError for values that are not finite and for an
  // impossible contact.
  std::span<const Pass> pass(std::span<const Touch> touches, std::span<const double> displacement);

  // The same for runs that compute no forces. The tip pulls once it has brought the contact node's
  // prescribed place off the surface at rest, outwards; for a body at rest with a positive definite
  // compliance the normal force has that sign. settings().release_force is not used.
  std::span<const Pass> pass_without_force(std::span<const Touch> touches,
                                           std::span<const double> displacement);

  // Finds the point of the surface that is nearest to each tip, where a proxy may begin: no contact
  // is decided.
  std::span<const Pass> nearest(std::span<const Touch> touches,
                                std::span<const double> displacement);

  // Keeps the contacts, which must not be judged by this U; only the surface follows, for the
  // picture.
  std::span<const Pass> keep(std::span<const Contact> present,
                             std::span<const double> displacement);

  // The displacement that thesis §3.7 prescribes at the contact node and at every node of its
  // patch.
  Eigen::Vector3d prescribed_displacement(const Contact& contact, const Eigen::Vector3d& tip) const;

  // The nodes that move with `node`, itself included, ascending: free surface nodes that are
  // reached from it over the surface without leaving the patch radius (straight distances at rest;
  // a thin body's far side does not belong). Throws InputError for a node that cannot be touched.
  std::span<const int> patch(int node) const;

  // The operations of the last pass, estimated by counting boxes, triangles and nodes tried; before
  // the first pass those of a search that tries one leaf.
  double pass_flops() const { return pass_flops_; }

  bool touchable(int node) const;
  const ContactSettings& settings() const { return settings_; }
  const DeformedSurface& surface() const { return surface_; }

 private:
  SurfaceSpot spot_of(const SurfacePoint& point) const;
  void require_touchable(const Contact& present) const;
  bool pulls(const Touch& touch) const;
  bool pulls_off(const Touch& touch) const;
  template <class Pulls>
  std::span<const Pass> pass(std::span<const Touch> touches, std::span<const double> displacement,
                             const Pulls& pulls);
  Pass start(const Eigen::Vector3d& tip, SearchCost& cost) const;
  Pass proceed(const Touch& touch, std::span<const double> displacement, SearchCost& cost);
  bool is_free(int node) const;
  Eigen::Vector3d undragged(int node, const Eigen::Vector3d& displacement) const;
  Eigen::Vector3d grip_offset(const Eigen::Vector3d& node_position, const Eigen::Vector3d& tip,
                              const Eigen::Vector3d& normal) const;
  void find_patches();

  ContactSettings settings_;
  DeformedSurface surface_;
  std::vector<std::uint8_t> anchored_;  // one for each node of the mesh
  std::vector<int> patch_begin_;  // begin of each node's patch in patch_; empty without a radius
  std::vector<int> patch_;
  std::vector<Pass> passes_;  // one for each probe
  double pass_flops_ = 0.0;
};

}  // namespace hvp::collision
