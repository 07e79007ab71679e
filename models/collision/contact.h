#pragma once

#include <Eigen/Core>
#include <optional>

#include "models/config/declaration.h"

namespace hvp::collision {

// A point of a body's surface, at rest or as deformed: weights of the corners of a triangle.
struct SurfaceSpot {
  int triangle = -1;                                 // of mesh::TetMesh::boundary; −1: none
  Eigen::Vector3d weight = Eigen::Vector3d::Zero();  // of its corners, none negative, sum one

  bool present() const { return triangle >= 0; }
  friend bool operator==(const SurfaceSpot&, const SurfaceSpot&) = default;
};

// The node that follows a probe, and its offset. node = -1: no contact. Where contact is a proxy,
// its spot, and of that triangle's corners the nearest one as `node`.
//
// The node's prescribed displacement is tip + offset − rest position: see
// ContactSearch::prescribed_displacement.
struct Contact {
  int node = -1;                                     // node of the mesh
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  // m, along the surface when contact began
  SurfaceSpot spot = {};

  bool present() const { return node >= 0; }
  friend bool operator==(const Contact&, const Contact&) = default;
};

// The touch of one probe: its tip, its contact and its force.
struct Touch {
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();  // m
  Contact contact = {};
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // on the body, N
  // Of a proxy, zero else.
  Eigen::Vector3d foot = Eigen::Vector3d::Zero();  // its place on the surface at rest, m
  double gap = 0;                                  // from the tip to the body's surface there, m
  double unresolved = 0;  // of the depth, what a probe of its size would not have, m
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // of the surface at rest there, outward
  double depth = 0;  // of the tip below the surface at rest there, m
  bool slides = false;
};

// What the tip touches.
enum class ContactKind {
  node,   // a node, or a patch of nodes, follows the tip: thesis §3.7
  proxy,  // a point of the surface presses on the body and glides (proxy_contact.h)
  patch,  // a patch of the surface as large as the probe does (footprint.h)
};

// The rule for a contact node's offset from the tip.
enum class Grip {
  offset,  // the node keeps the sideways distance to the tip that it had when contact began
  snap,    // the node is at the tip, as thesis §3.7 has it literally
};

// The effect [contact.fresh]: contact is found anew in every frame, without taking time, instead of
// the 33 Hz process' last result.
struct FreshContact {
  void declare(config::Visitor&) {}
};

// Rules of contact: scenario table [contact]. docs/collision.md gives the reasons.
struct ContactSettings {
  ContactKind kind = ContactKind::proxy;
  double friction = 0.3;  // of a proxy or a patch: Coulomb's coefficient
  Grip grip = Grip::offset;
  double hysteresis = 0.05;    // fraction by which another node must be nearer to take over
  double release_force = 0.0;  // N, pull along the outward normal above which contact ends
  double patch_radius = 0.0;   // m; 0: a single node
  double hand_over_s = 30e-3;  // 0: the prescribed displacement jumps
  std::optional<FreshContact> fresh = {};

  bool glides() const { return kind != ContactKind::node; }
  void declare(config::Visitor& v);

 private:
  void declare_node(config::Visitor& v);
};

}  // namespace hvp::collision
