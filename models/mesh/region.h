#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/config/declaration.h"
#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

// A part of the body as a scenario names it: the anchored nodes, or a loaded patch.
struct Region {
  enum class Kind {
    lowest_fraction,  // a fraction of all nodes: those that lie lowest along `direction`
    half_space,       // (x − point)·normal ≤ 0: `normal` points out of the region
    box,              // between two corners, faces included
    sphere,           // within `radius` of `centre`, surface included
    all,
  };

  Kind kind = Kind::lowest_fraction;
  double fraction = 0.15;
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d low_corner = Eigen::Vector3d::Zero();
  Eigen::Vector3d high_corner = Eigen::Vector3d::Zero();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0.0;

  void declare(config::Visitor& v);
  // The keys of one kind.
  void declare_half_space(config::Visitor& v);
  void declare_box(config::Visitor& v);
  void declare_sphere(config::Visitor& v);
  // Throws InputError for a direction or normal of length zero and for an empty box or sphere.
  void check() const;
};

// The nodes in the region, ascending; may be empty. `lowest_fraction` takes round(fraction · n)
// nodes, at least one where fraction > 0, and at equal height the lower index first. The other
// kinds admit nodes outside by up to 1e-9 of the mesh's diagonal, so that rounding in the last
// bit does not decide whether a node on the region's surface belongs to it.
std::vector<int> select_nodes(const Region& region, const TetMesh& mesh);

// The boundary triangles (indices into TetMesh::boundary, ascending) all of whose nodes are in
// the region.
std::vector<int> select_boundary(const Region& region, const TetMesh& mesh);

}  // namespace hvp::mesh
