#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "models/collision/contact_settings.h"
#include "models/collision/deformed_surface.h"

namespace hvp::collision {

// Which node follows the probe and how. node = -1: no contact.
//
// The node's prescribed displacement is tip + offset − rest position: see
// ContactSearch::prescribed_displacement.
struct Contact {
  int node = -1;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  // m, along the surface when contact began

  bool present() const { return node >= 0; }
  friend bool operator==(const Contact&, const Contact&) = default;
};

enum class ContactEvent {
  none,      // no contact before, none now
  started,   // the tip reached the body
  held,      // the same node
  slid,      // another node took over
  released,  // the tip had begun to pull
};

struct Pass {
  Contact contact;
  ContactEvent event = ContactEvent::none;
  double flops = 0.0;  // of this pass
};

// The collision half of the 33 Hz process (thesis §6.2.3): once a pass, decides which node is in
// contact. The rules and their reasons stand in docs/collision.md. The result is a function of
// the arguments alone; from one pass to the next nothing is remembered but the cost.
class ContactSearch {
 public:
  // `anchored`: nodes that are held and cannot be touched, in any order. Throws InputError as
  // DeformedSurface does; for an anchored node that the mesh does not have; where no surface
  // node is free; for a patch radius that puts more than four million entries into the patches.
  ContactSearch(const mesh::TetMesh& mesh, std::span<const int> anchored,
                const ContactSettings& settings);

  // `tip`: centre of the probe, m. `displacement`: the last known U, x, y, z of every node, m.
  // `present`: the contact that this U was computed with. `force`: what the tip applies to the
  // body at that contact (thesis Fig. 3.5c; the patch's sum), N; not looked at without one.
  // Throws InputError for values that are not finite and for a contact that cannot be.
  Pass pass(const Eigen::Vector3d& tip, std::span<const double> displacement,
            const Contact& present, const Eigen::Vector3d& force);

  // Where nobody computes forces: the tip pulls once it has brought the contact node's prescribed
  // place off the surface at rest, outwards. To a body at rest with a positive definite compliance
  // the normal forces have that sign; settings().release_force has nothing to be compared with.
  Pass pass_without_force(const Eigen::Vector3d& tip, std::span<const double> displacement,
                          const Contact& present);

  // A contact that is not to be judged by this U: it stays, the surface follows for the picture.
  Pass keep(std::span<const double> displacement, const Contact& present);

  // The displacement that §3.7 prescribes at the contact node, and at every node of its patch.
  Eigen::Vector3d prescribed_displacement(const Contact& contact, const Eigen::Vector3d& tip) const;

  // The nodes that move with `node`, itself included, ascending: free surface nodes that are
  // reached from it over the surface without leaving the patch radius (straight distances at
  // rest, so a thin body's far side does not belong). Throws InputError for a node that cannot
  // be touched.
  std::span<const int> patch(int node) const;

  // Operations of the last pass, an estimate by counting boxes, triangles and nodes tried;
  // before the first pass those of a search that tries one leaf.
  double pass_flops() const { return pass_flops_; }

  bool touchable(int node) const;
  const ContactSettings& settings() const { return settings_; }
  const DeformedSurface& surface() const { return surface_; }

 private:
  void require_touchable(const Contact& present) const;
  Pass pass(const Eigen::Vector3d& tip, std::span<const double> displacement,
            const Contact& present, bool pulls);
  Pass start(const Eigen::Vector3d& tip, SearchCost& cost) const;
  Pass proceed(const Eigen::Vector3d& tip, std::span<const double> displacement,
               const Contact& present, SearchCost& cost);
  Eigen::Vector3d undragged(int node, const Eigen::Vector3d& displacement) const;
  Eigen::Vector3d grip_offset(const Eigen::Vector3d& node_position, const Eigen::Vector3d& tip,
                              const Eigen::Vector3d& normal) const;
  void find_patches();

  ContactSettings settings_;
  DeformedSurface surface_;
  std::vector<std::uint8_t> anchored_;  // one a node of the mesh
  std::vector<std::uint8_t> excluded_;  // anchored, and during a pass prescribed
  std::vector<int> patch_begin_;        // a node's patch in patch_; without a radius empty
  std::vector<int> patch_;
  double pass_flops_ = 0.0;
};

}  // namespace hvp::collision
