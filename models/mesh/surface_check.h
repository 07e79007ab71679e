#pragma once

#include <string>

#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

// Throws InputError with the key "surface".
[[noreturn]] void refuse(const std::string& message);

// Six times ∫dV would be the sum of det(a, b, c) over the triangles; this is the volume itself in
// m³, positive for outward normals.
double enclosed_volume(const Surface& surface);

// m²
double surface_area(const Surface& surface);

// Merges points that coincide exactly, drops triangles that thereby lose a corner, and drops
// points that no triangle uses. The order of what remains is kept.
Surface merge_points(const Surface& surface);

// The surface as a mesher needs it: points merged, all triangles wound the same way with outward
// normals. Throws InputError with the key "surface" where it is not the closed surface of one
// body: no triangles, coordinates that are no numbers, open or non-manifold edges, sheets that
// meet in a point, a surface with one side, several shells, triangles without area, no volume,
// self-intersection. The message counts what was found.
Surface check_surface(const Surface& raw);

}  // namespace hvp::mesh
