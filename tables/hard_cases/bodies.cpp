#include "tables/hard_cases/bodies.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "app/mesh/sandboxed_mesh.h"
#include "models/fem/assembly.h"
#include "models/fem/materials.h"
#include "models/index.h"
#include "models/mesh/region.h"

namespace hvp::tables {

namespace {

using Eigen::Vector3d;
using Tetrahedron = std::array<int, 4>;

double determinant(const mesh::TetMesh& mesh, const Tetrahedron& t) {
  return mesh::jacobian_determinant(mesh.nodes[at(t[0])], mesh.nodes[at(t[1])],
                                    mesh.nodes[at(t[2])], mesh.nodes[at(t[3])]);
}

double longest_edge(const mesh::TetMesh& mesh, const Tetrahedron& t) {
  double longest = 0;
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < a; ++b) {
      longest = std::max(longest, (mesh.nodes[at(t[at(a)])] - mesh.nodes[at(t[at(b)])]).norm());
    }
  }
  return longest;
}

// The point over the centre of the face from which the face's edges are seen under the angle, on
// average: the inscribed circle's radius times its tangent above the face.
Vector3d above_face(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& apex,
                    double tangent) {
  const double across_a = (b - c).norm();
  const double across_b = (c - a).norm();
  const double across_c = (a - b).norm();
  const double perimeter = across_a + across_b + across_c;
  const Vector3d centre = (across_a * a + across_b * b + across_c * c) / perimeter;
  const Vector3d normal = (b - a).cross(c - a);
  const double radius = normal.norm() / perimeter;
  const Vector3d up = normal.normalized() * (normal.dot(apex - a) > 0 ? 1.0 : -1.0);
  return centre + radius * tangent * up;
}

}  // namespace

int Body::nearest(const Vector3d& point) const {
  int best = 0;
  double least = -1;
  for (std::size_t i = 0; i < free_nodes.size(); ++i) {
    const double distance = (mesh.nodes[at(free_nodes[i])] - point).squaredNorm();
    if (least >= 0 && distance >= least) continue;
    least = distance;
    best = static_cast<int>(i);
  }
  return best;
}

const mesh::TetMesh& sphere(int nodes) {
  static std::map<int, mesh::TetMesh> meshes;
  const auto found = meshes.find(nodes);
  if (found != meshes.end()) return found->second;
  mesh::MeshSettings settings;
  settings.nodes = nodes;
  return meshes.emplace(nodes, app::sandboxed_mesh(settings)).first->second;
}

std::vector<int> lowest_nodes(const mesh::TetMesh& mesh, double fraction) {
  mesh::Region region;
  region.fraction = fraction;
  return mesh::select_nodes(region, mesh);
}

Body make_body(const mesh::TetMesh& mesh, const Solid& solid, std::span<const int> held) {
  std::vector<fem::Material> table;
  std::vector<int> of_element;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    Vector3d centre = Vector3d::Zero();
    for (const int n : mesh.tetrahedra[e]) centre += mesh.nodes[at(n)] / 4;
    fem::Material material;
    material.poisson_ratio = solid.poisson_ratio;
    material.young_modulus_pa = solid.young_modulus_pa;
    if (solid.contrast) material.young_modulus_pa *= solid.contrast(centre);
    of_element.push_back(static_cast<int>(table.size()));
    table.push_back(material);
  }
  const sparse::BlockMatrix stiffness =
      fem::assemble_stiffness(mesh, {std::move(table), std::move(of_element)});
  Body body{.mesh = mesh, .free_nodes = {}, .stiffness = {}};
  for (int n = 0; n < stiffness.block_rows(); ++n) {
    if (std::find(held.begin(), held.end(), n) == held.end()) body.free_nodes.push_back(n);
  }
  body.stiffness = stiffness.submatrix(body.free_nodes);
  return body;
}

mesh::TetMesh with_slivers(mesh::TetMesh mesh, int count, double angle_degrees) {
  const double tangent = std::tan(angle_degrees * std::numbers::pi / 180);
  std::vector<char> untouchable(mesh.nodes.size(), 0);
  for (const auto& triangle : mesh.boundary) {
    for (const int n : triangle) untouchable[at(n)] = 1;
  }
  int made = 0;
  for (const Tetrahedron& t : mesh.tetrahedra) {
    for (int corner = 0; corner < 4 && made < count; ++corner) {
      const int moved = t[at(corner)];
      if (untouchable[at(moved)] != 0) continue;
      const Vector3d before = mesh.nodes[at(moved)];
      mesh.nodes[at(moved)] = above_face(mesh.nodes[at(t[at((corner + 1) % 4)])],
                                         mesh.nodes[at(t[at((corner + 2) % 4)])],
                                         mesh.nodes[at(t[at((corner + 3) % 4)])], before, tangent);
      // The elements around the node have to stay as good as elements are, but for this one.
      std::vector<const Tetrahedron*> around;
      bool good = determinant(mesh, t) > 0;
      for (const Tetrahedron& other : mesh.tetrahedra) {
        if (std::find(other.begin(), other.end(), moved) == other.end()) continue;
        around.push_back(&other);
        const double edge = longest_edge(mesh, other);
        if (&other != &t) good = good && determinant(mesh, other) > 0.02 * edge * edge * edge;
      }
      if (!good) {
        mesh.nodes[at(moved)] = before;
        continue;
      }
      for (const Tetrahedron* other : around) {
        for (const int n : *other) untouchable[at(n)] = 1;
      }
      ++made;
    }
  }
  if (made < count) throw std::logic_error("the mesh has no room for so many slivers");
  return mesh;
}

mesh::TetMesh squashed(mesh::TetMesh mesh, double factor) {
  for (Vector3d& node : mesh.nodes) node.z() *= factor;
  return mesh;
}

}  // namespace hvp::tables
