#include "models/mesh/volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "models/config/input_error.h"
#include "models/mesh/mesh_settings.h"

namespace hvp::mesh {

namespace {

Region::Kind kind_of(Volume::Shape shape) {
  switch (shape) {
    case Volume::Shape::box:
      return Region::Kind::box;
    case Volume::Shape::half_space:
      return Region::Kind::half_space;
    case Volume::Shape::sphere:
    case Volume::Shape::surface:
      break;
  }
  return Region::Kind::sphere;
}

}  // namespace

void Volume::declare(config::Visitor& v) {
  const auto of_shape = v.variant(
      "shape", shape,
      {{"sphere", Shape::sphere},
       {"box", Shape::box},
       {"half-space", Shape::half_space},
       {"surface", Shape::surface}},
      {.help = "where it is; an element belongs if its centroid is inside", .source = "a lump"});
  region.kind = kind_of(shape);
  of_shape.only({Shape::half_space}, [&] { region.declare_half_space(v); });
  of_shape.only({Shape::box}, [&] { region.declare_box(v); });
  of_shape.only({Shape::sphere}, [&] { region.declare_sphere(v); });
  of_shape.only({Shape::surface}, [&] {
    v.file("surface", surface,
           {.help = "closed surface in the body's coordinates: STL, PLY, OBJ, VTP or VTU",
            .required = true});
    v.quantity("surface_unit", surface_unit, config::Dimension::length, kUnitLength,
               {.help = "length of one unit of the surface file",
                .source = "surface files carry no unit; millimetres are customary in STL"});
  });
}

void Volume::check() const {
  if (shape != Shape::surface) return region.check();
  if (surface.empty()) {
    throw InputError("surface", "shape = \"surface\" needs a file (STL, PLY, OBJ, VTP or VTU)");
  }
}

std::vector<int> elements_in(const Volume& volume, const TetMesh& mesh, const Surface& surface) {
  TetMesh centroids;
  centroids.nodes.reserve(mesh.tetrahedra.size());
  for (const auto& node : mesh.tetrahedra) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const int n : node) sum += mesh.nodes[static_cast<std::size_t>(n)];
    centroids.nodes.emplace_back(sum / 4);
  }
  if (volume.shape != Volume::Shape::surface) return select_nodes(volume.region, centroids);
  const Eigen::AlignedBox3d box = box_around(surface.points);
  std::vector<int> inside;
  for (std::size_t e = 0; e < centroids.nodes.size(); ++e) {
    // A half on a face, and as much as its angle has on an edge or a corner.
    constexpr double kOutside = 0.01;
    if (box.contains(centroids.nodes[e]) &&
        winding_number(surface, centroids.nodes[e]) > kOutside) {
      inside.push_back(static_cast<int>(e));
    }
  }
  return inside;
}

double winding_number(const Surface& surface, const Eigen::Vector3d& point) {
  double sum = 0;  // half the solid angle
  for (const auto& triangle : surface.triangles) {
    const Eigen::Vector3d a = surface.points[static_cast<std::size_t>(triangle[0])] - point;
    const Eigen::Vector3d b = surface.points[static_cast<std::size_t>(triangle[1])] - point;
    const Eigen::Vector3d c = surface.points[static_cast<std::size_t>(triangle[2])] - point;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    const double along = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    const double determinant = a.dot(b.cross(c));
    // From within the triangle as much of it is seen on either side.
    if (determinant != 0) sum += std::atan2(determinant, along);
  }
  return sum / (2 * std::numbers::pi);
}

}  // namespace hvp::mesh
