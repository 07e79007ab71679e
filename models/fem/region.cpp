#include "models/fem/region.h"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fem/assembly.h"
#include "models/index.h"

namespace hvp::fem {

void Region::declare(config::Visitor& v, const Material& of_body) {
  v.text("name", name, {"what reports call it", "absent: region[0], region[1] and so on"});
  v.include(volume);
  if (!material) material = of_body;
  material->declare_of_region(v);
}

std::string name_of(std::span<const Region> regions, std::size_t index) {
  return regions[index].name.empty() ? fmt::format("region[{}]", index) : regions[index].name;
}

void check_names(std::span<const Region> regions) {
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (name_of(regions, i) == kOfBody) {
      throw InputError(
          fmt::format("region[{}].name", i),
          fmt::format("\"{}\" is the name of what no region has; expected another", kOfBody));
    }
    for (std::size_t earlier = 0; earlier < i; ++earlier) {
      if (name_of(regions, i) != name_of(regions, earlier)) continue;
      throw InputError(
          fmt::format("region[{}].name", i),
          fmt::format("region[{}] has this name too; expected one of its own", earlier));
    }
  }
}

Materials materials_of(const mesh::TetMesh& mesh, const Material& of_body,
                       std::span<const Region> regions, std::span<const mesh::Surface> surfaces) {
  if (regions.empty()) return of_body;
  std::vector<Material> table = {of_body};
  std::vector<int> of_element(mesh.tetrahedra.size(), 0);
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const std::vector<int> found = mesh::elements_in(regions[i].volume, mesh, surfaces[i]);
    if (found.empty()) {
      throw InputError(fmt::format("region[{}]", i),
                       fmt::format("the centroid of none of the {} elements is inside; expected at "
                                   "least one: a place in the body, a larger region or a finer "
                                   "mesh",
                                   mesh.tetrahedra.size()));
    }
    table.push_back(regions[i].material.value_or(of_body));
    for (const int e : found) of_element[at(e)] = static_cast<int>(i) + 1;
  }
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (std::ranges::find(of_element, static_cast<int>(i) + 1) != of_element.end()) continue;
    throw InputError(fmt::format("region[{}]", i),
                     "all its elements are in regions that are listed later, which they belong to; "
                     "expected at least one of its own");
  }
  return {std::move(table), std::move(of_element)};
}

std::vector<Share> shares_of(const mesh::TetMesh& mesh, const Materials& materials) {
  std::vector<Share> shares(materials.count());
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const double volume = element_geometry(mesh, static_cast<int>(e)).volume();
    Share& share = shares[materials.index_of(e)];
    ++share.elements;
    share.volume_m3 += volume;
    share.mass_kg += materials.of(e).density_kg_m3 * volume;
  }
  return shares;
}

}  // namespace hvp::fem
