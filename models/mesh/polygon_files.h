#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "models/mesh/tet_mesh.h"

// The three formats of surfaces that every program writes, read as viewers do: points and faces,
// and nothing of what else stands in a file. Texts may begin with a byte-order mark and end in NULs
// or without a line end.
namespace hvp::mesh {

struct Polygons {
  std::vector<Eigen::Vector3d> points;     // in the file's unit, as single precision has them
  std::vector<std::vector<int>> polygons;  // three corners or more, indices into `points`
};

// Each throws InputError with the key "surface" and, for a text, the line: what is not a file of
// the format, is cut off, has a coordinate or a corner that is no number, names a point that is not
// there, or has more than kMostTriangles faces. A header that promises more than the file holds is
// refused before anything is allocated.

// STL, binary (a header of 80 bytes, a count, 50 bytes a triangle) or text ("solid …").
Polygons read_stl(std::string_view bytes);
// Wavefront OBJ: its lines v and f; comments, and lines that a backslash continues. A corner is
// v, v/vt, v//vn or v/vt/vn, counted from one or, if negative, from the last vertex.
Polygons read_obj(std::string_view bytes);
// A surface as such a file, in a unit of so many metres; its coordinates are read again as they
// are, but for single precision.
std::string obj_text(const Surface& surface, double unit_m);
// PLY, text or binary of either byte order: x, y and z of the element vertex, and the list
// vertex_indices (or vertex_index) of the element face.
Polygons read_ply(std::string_view bytes);

}  // namespace hvp::mesh
