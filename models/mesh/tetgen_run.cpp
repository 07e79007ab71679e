#include "models/mesh/tetgen_run.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <tetgen.h>

#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::mesh {

namespace {

// tetgenio releases its arrays with delete[], so they are handed over raw.
void set_points(tetgenio& in, const std::vector<Eigen::Vector3d>& points) {
  in.firstnumber = 0;
  in.numberofpoints = static_cast<int>(points.size());
  in.pointlist = new REAL[3 * points.size()];
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      in.pointlist[3 * i + k] = points[i][static_cast<Eigen::Index>(k)];
    }
  }
}

void set_facets(tetgenio& in, const std::vector<std::array<int, 3>>& triangles) {
  in.numberoffacets = static_cast<int>(triangles.size());
  in.facetlist = new tetgenio::facet[triangles.size()];
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    tetgenio::facet& facet = in.facetlist[i];
    tetgenio::init(&facet);
    facet.numberofpolygons = 1;
    facet.polygonlist = new tetgenio::polygon[1];
    tetgenio::init(facet.polygonlist);
    facet.polygonlist[0].numberofvertices = 3;
    facet.polygonlist[0].vertexlist = new int[3]{triangles[i][0], triangles[i][1], triangles[i][2]};
  }
}

// The meaning of the number that TetGen throws (terminatetetgen in tetgen.h).
std::string explain(int code) {
  switch (code) {
    case 1:
      return "TetGen ran out of memory";
    case 3:
      return "TetGen found that the surface intersects itself";
    case 4:
      return "TetGen found features too small to resolve (two points or a point and a triangle "
             "almost touch)";
    case 5:
      return "TetGen found two triangles that almost coincide";
    default:
      return fmt::format("TetGen gave up on the surface (code {})", code);
  }
}

void call(std::string switches, tetgenio& in, tetgenio& out) {
  try {
    ::tetrahedralize(switches.data(), &in, &out);
  } catch (int code) {
    throw InputError("surface", explain(code));
  } catch (const std::bad_alloc&) {
    throw InputError("surface", explain(1));
  }
}

// The faces that belong to one tetrahedron only. The order is that of the tetrahedra, which
// does not depend on how TetGen lists its faces.
std::vector<std::array<int, 3>> boundary_of(const std::vector<std::array<int, 4>>& tetrahedra) {
  // Outward for det J > 0.
  static constexpr std::array<std::array<std::size_t, 3>, 4> kFaces{
      {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
  std::map<std::array<int, 3>, int> uses;
  const auto sorted = [](std::array<int, 3> face) {
    std::sort(face.begin(), face.end());
    return face;
  };
  for (const auto& t : tetrahedra) {
    for (const auto& f : kFaces) ++uses[sorted({t[f[0]], t[f[1]], t[f[2]]})];
  }
  std::vector<std::array<int, 3>> boundary;
  for (const auto& t : tetrahedra) {
    for (const auto& f : kFaces) {
      const std::array<int, 3> face{t[f[0]], t[f[1]], t[f[2]]};
      if (uses[sorted(face)] == 1) boundary.push_back(face);
    }
  }
  return boundary;
}

}  // namespace

TetMesh run_tetgen(const Surface& surface, const TetgenOptions& options) {
  tetgenio in;
  tetgenio out;
  set_points(in, surface.points);
  set_facets(in, surface.triangles);
  std::string switches = options.keep_surface ? "pYQ" : "pQ";
  if (options.most_added > 0) switches += fmt::format("S{}", options.most_added);
  if (options.radius_edge_ratio > 0.0)
    switches += fmt::format("q{:.6f}", options.radius_edge_ratio);
  // TetGen reads plain decimals and exponents alike.
  if (options.max_volume > 0.0) switches += fmt::format("a{:.12e}", options.max_volume);
  call(switches, in, out);

  TetMesh mesh;
  std::vector<char> used(at(out.numberofpoints), 0);
  for (int i = 0; i < 4 * out.numberoftetrahedra; ++i) used[at(out.tetrahedronlist[i])] = 1;
  std::vector<int> index(at(out.numberofpoints), -1);
  for (int i = 0; i < out.numberofpoints; ++i) {
    if (used[at(i)] == 0) continue;
    index[at(i)] = static_cast<int>(mesh.nodes.size());
    mesh.nodes.emplace_back(out.pointlist[3 * i], out.pointlist[3 * i + 1],
                            out.pointlist[3 * i + 2]);
  }
  for (int e = 0; e < out.numberoftetrahedra; ++e) {
    std::array<int, 4> t{};
    for (int k = 0; k < 4; ++k) t[at(k)] = index[at(out.tetrahedronlist[4 * e + k])];
    const auto x = [&](std::size_t k) { return mesh.nodes[at(t[k])]; };
    // TetGen orders all its tetrahedra one way, det J < 0; the check keeps that an observation.
    if (jacobian_determinant(x(0), x(1), x(2), x(3)) < 0.0) std::swap(t[0], t[1]);
    if (!(jacobian_determinant(x(0), x(1), x(2), x(3)) > 0.0)) {
      throw InputError("surface", fmt::format("TetGen made a tetrahedron without volume, number "
                                              "{} of {}; the surface has degenerate parts",
                                              e, out.numberoftetrahedra));
    }
    mesh.tetrahedra.push_back(t);
  }
  if (mesh.tetrahedra.empty()) {
    throw InputError("surface", "TetGen found no volume inside the surface");
  }
  mesh.boundary = boundary_of(mesh.tetrahedra);
  return mesh;
}

}  // namespace hvp::mesh
