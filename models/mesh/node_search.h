#pragma once

#include <functional>
#include <vector>

#include "models/mesh/progress.h"
#include "models/mesh/tet_mesh.h"

// The search for a mesh with a wanted number of nodes. TetGen keeps the surface and takes a bound
// on the volume of a tetrahedron; the number of nodes is known only afterwards.
namespace hvp::mesh {

// The accepted deviation from the wanted count, as a share of it.
inline constexpr double kAcceptedDeviation = 0.10;

// The edge length L for which a body of this volume and area gets `nodes` nodes:
// n = 2 + 0.703·A/L² + 0.930·V/L³, fitted to TetGen's meshes of a sphere with 100 to 900 points
// on it; it is off by 2 % at most there, and only the start of a search.
double edge_length_for(double volume, double area, int nodes);

// The number of points of a closed surface of this area that is made of equilateral triangles with
// this edge.
int points_for(double area, double edge);

// A surface that may give the wanted count, made when it is tried.
struct Candidate {
  std::function<Surface()> surface;
  double edge = 0.0;  // edge of the tetrahedra inside, to start from
  // True if TetGen's bound on the ratio of circumradius to shortest edge may be loosened.
  bool loose_ratio = true;
  bool keep_surface = true;  // TetgenOptions
};

// The candidates for a count.
using Candidates = std::function<std::vector<Candidate>(int wanted)>;

// Tries the candidates one after the other, each with varied volume bounds, until one gives the
// wanted count within kAcceptedDeviation and no sliver; failing that, the one with the fewest
// slivers. A coarse surface bounds the count from above, since TetGen puts no node into the
// smallest sphere around one of its triangles, and a fine one from below. Throws InputError with
// the key "nodes" where none gives the count: the message offers the nearest count for which a mesh
// was then made in the same way.
TetMesh mesh_first_that_fits(const Candidates& candidates, int wanted, const Progress& progress);

}  // namespace hvp::mesh
