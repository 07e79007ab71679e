#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "models/collision/triangles.h"
#include "models/index.h"
#include "models/mesh/tet_mesh.h"

namespace hvp::collision {

// The point of the surface that is nearest to a given one.
struct SurfacePoint {
  int triangle = -1;                                 // into TetMesh::boundary
  Feature feature = Feature::face;                   // feature of that triangle
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   // m
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // the feature's normal; outward, length one
  double signed_distance = 0.0;                      // m; negative inside the body
  SearchCost cost;
};

// The boundary of a body, displaced by U, against which the probe is tested.
//
// The sign of a distance follows from the angle-weighted pseudo-normal of the nearest face, edge or
// corner (Bærentzen & Aanæs, IEEE TVCG 11(3), 2005), which is right everywhere for a closed surface
// that does not intersect itself; the normal of any one adjacent face is wrong beside edges and
// corners. Where the deformed surface intersects itself the sign is that of the nearest sheet.
//
// Queries allocate nothing and may run in parallel, but not beside update(). Node numbers are those
// of the mesh.
class DeformedSurface {
 public:
  // The surface at rest. Copies the parts of the mesh that it uses. Throws InputError where the
  // boundary is empty, names a node that does not exist, is not closed (every side of a triangle
  // belongs to one other triangle, which runs through it the other way) or faces inwards.
  explicit DeformedSurface(const mesh::TetMesh& mesh);

  // `displacement` is U: x, y, z of every node of the mesh, in metres. Throws InputError for
  // another size or a value that is not finite; the surface is then undefined until the next
  // successful update.
  void update(std::span<const double> displacement);

  // The nearest point of the surface. These throw InputError where p is not finite.
  SurfacePoint closest(const Eigen::Vector3d& p) const;
  double signed_distance(const Eigen::Vector3d& p) const { return closest(p).signed_distance; }

  int nodes() const { return static_cast<int>(rest_.size()); }
  const std::vector<std::array<int, 3>>& triangles() const { return triangles_; }
  // The nodes of the surface, ascending.
  const std::vector<int>& surface_nodes() const { return surface_nodes_; }
  bool on_surface(int node) const { return ring_begin_[at(node) + 1] > ring_begin_[at(node)]; }
  // The triangles across a triangle's sides ab, bc, ca.
  const std::array<int, 3>& neighbours(int triangle) const { return neighbour_[at(triangle)]; }
  // The triangles around a surface node, ascending.
  std::span<const int> ring(int node) const;

  const Eigen::Vector3d& rest_position(int node) const { return rest_[at(node)]; }
  // The displaced position of a surface node; other nodes stay at their rest positions.
  const Eigen::Vector3d& position(int node) const { return position_[at(node)]; }
  // The pseudo-normal of a surface node, length one, at rest and as displaced.
  const Eigen::Vector3d& rest_normal(int node) const { return rest_normal_[at(node)]; }
  Eigen::Vector3d normal(int node) const;

  // The additions, minima and maxima of one update.
  double update_flops() const;

 private:
  void check_indices() const;
  void find_rings();
  void find_neighbours();
  void check_outward() const;
  Eigen::Vector3d face_normal(int triangle) const;
  Eigen::Vector3d corner_normal(int node) const;
  Eigen::Vector3d feature_normal(int triangle, Feature feature) const;

  std::vector<Eigen::Vector3d> rest_;
  std::vector<Eigen::Vector3d> position_;
  std::vector<std::array<int, 3>> triangles_;
  std::vector<std::array<int, 3>> neighbour_;  // across sides ab, bc, ca
  std::vector<int> ring_begin_;                // begin of each node's triangles in ring_
  std::vector<int> ring_;
  std::vector<int> surface_nodes_;
  std::vector<Eigen::Vector3d> rest_normal_;
  BoxTree tree_;
};

}  // namespace hvp::collision
