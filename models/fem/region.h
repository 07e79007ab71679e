#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "models/config/declaration.h"
#include "models/fem/materials.h"
#include "models/mesh/tet_mesh.h"
#include "models/mesh/volume.h"

namespace hvp::fem {

// The name of what no region has.
inline constexpr std::string_view kOfBody = "object.material";

// A part of the body with a material of its own: a table of the scenario's [[object.region]].
struct Region {
  std::string name;
  mesh::Volume volume;
  // What the scenario does not state is the body's; absent: all of it.
  std::optional<Material> material;

  void declare(config::Visitor& v, const Material& of_body);
};

// "lump", or "region[0]" of one without a name.
std::string name_of(std::span<const Region> regions, std::size_t index);

// Throws InputError with the key "region[i].name" for a name that another region has.
void check_names(std::span<const Region> regions);

// The materials of a body: its own, and those of its regions in their order. An element belongs to
// the last region that has its centroid, otherwise to the body. `surfaces` has the closed surface
// of each region, with no triangles where its shape is another. Throws InputError with the key
// "region[i]" for a region that has no element.
Materials materials_of(const mesh::TetMesh& mesh, const Material& of_body,
                       std::span<const Region> regions, std::span<const mesh::Surface> surfaces);

// What a material of a body has of it.
struct Share {
  int elements = 0;
  double volume_m3 = 0;
  double mass_kg = 0;
};
// Of each material of the table.
std::vector<Share> shares_of(const mesh::TetMesh& mesh, const Materials& materials);

}  // namespace hvp::fem
