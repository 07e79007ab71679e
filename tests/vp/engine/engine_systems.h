#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "models/fixed/quantised_matrix.h"
#include "models/fixed/settings.h"
#include "models/sparse/block_matrix.h"

namespace hvp::test {

// Stiffness of a box of cells, held at one face.
sparse::BlockMatrix box_stiffness(int cells_x, int cells_y, int cells_z);
// Stiffness of the sphere of scenarios/thesis.toml with about so many nodes, its lowest 15 % held.
// Forks a mesher: before SystemC has processes.
sparse::BlockMatrix sphere_stiffness(int nodes);

// Words of a right-hand side with magnitudes up to `size`.
std::vector<std::int32_t> random_words(int count, std::int32_t size, std::uint64_t seed);

// The mesh set over which the levels are compared.
struct NamedMatrix {
  std::string name;
  fixed::QuantisedMatrix matrix;
};
std::vector<NamedMatrix> mesh_set(int matrix_bits = 12);

}  // namespace hvp::test
