#pragma once

#include <string>

#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

// Throws InputError with the key "surface".
[[noreturn]] void refuse(const std::string& message);

// Throws InputError with the key "surface" for no triangles, points that are not there, and
// coordinates that are no numbers.
void check_numbers(const Surface& surface);

// The volume in m³, a sixth of the sum of det(a, b, c) over the triangles; positive for outward
// normals.
double enclosed_volume(const Surface& surface);

// The area in m².
double surface_area(const Surface& surface);

// Merges points that are `distance` (m) or less apart, the first of them staying where it is; drops
// triangles that thereby lose a corner, and points that no triangle uses. The order of what remains
// is kept. With a distance of zero points coincide exactly.
Surface merge_points(const Surface& surface, double distance = 0);

// The distance that single precision cannot tell apart at the surface's size, m: a CAD program's
// 2.7e-16 for 0 is no other place.
double merging_distance(const Surface& surface);

// The surface as a mesher needs it: points merged, all triangles wound the same way with outward
// normals. Throws InputError with the key "surface" if it is not the closed surface of one body: no
// triangles, coordinates that are no numbers, open or non-manifold edges, sheets that meet in a
// point, a surface with one side, several shells, triangles without area, no volume,
// self-intersection. The message counts what was found.
Surface check_surface(const Surface& raw);

// Throws InputError with the key "surface" if triangles of a closed manifold surface cross, overlap
// or touch other than in a common edge or corner. Exact predicates decide, so that rounding neither
// invents nor hides a crossing.
void check_intersections(const Surface& surface);

}  // namespace hvp::mesh
