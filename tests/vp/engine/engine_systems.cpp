#include "tests/vp/engine/engine_systems.h"

#include "models/fem/body.h"
#include "models/mesh/generate.h"
#include "models/mesh/region.h"
#include "tests/fixed/elastic_box.h"

namespace hvp::test {

sparse::BlockMatrix box_stiffness(int cells_x, int cells_y, int cells_z) {
  return fixed::test::make_body({.cells_x = cells_x, .cells_y = cells_y, .cells_z = cells_z})
      .stiffness;
}

sparse::BlockMatrix sphere_stiffness(int nodes) {
  mesh::MeshSettings settings;
  settings.nodes = nodes;
  mesh::TetMesh mesh = mesh::generate(settings);
  const std::vector<int> anchored = mesh::select_nodes(mesh::Region{}, mesh);
  return fem::Body(std::move(mesh), fem::Material{}, anchored, fem::AnchorTreatment::removed)
      .stiffness();
}

std::vector<std::int32_t> random_words(int count, std::int32_t size, std::uint64_t seed) {
  fixed::test::Random random(seed);
  std::vector<std::int32_t> words(static_cast<std::size_t>(count));
  for (std::int32_t& word : words) word = static_cast<std::int32_t>(random.symmetric() * size);
  return words;
}

std::vector<NamedMatrix> mesh_set(int matrix_bits) {
  std::vector<NamedMatrix> set;
  const auto add = [&](std::string name, const sparse::BlockMatrix& matrix) {
    set.push_back({std::move(name), fixed::quantise(matrix, matrix_bits)});
  };
  add("box of 100", box_stiffness(4, 4, 4 - 1));
  add("box of 294", box_stiffness(6, 6, 5));
  add("box of 900", box_stiffness(9, 9, 9));
  for (const int nodes : {100, 200, 500, 1000}) {
    add("sphere of " + std::to_string(nodes), sphere_stiffness(nodes));
  }
  return set;
}

}  // namespace hvp::test
