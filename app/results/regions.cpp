#include "app/results/regions.h"

#include <cstddef>
#include <iterator>

#include <fmt/format.h>

#include "app/results/number_text.h"
#include "app/scenario/message.h"
#include "app/scene/scene.h"
#include "models/fem/region.h"

namespace hvp::results {

void RegionFigures::report(config::Figures& f) const {
  f.text("name", name, "the region's; `object.material`: what no region has");
  f.count("elements", elements, "that belong to it");
  f.quantity("volume_m3", volume_m3, "m³", "theirs");
  f.ratio("volume_share", share, "of the body's volume");
  f.quantity("mass_kg", mass_kg, "kg", "theirs");
  f.quantity("young_modulus_Pa", young_modulus_pa, "Pa", "of its material");
  f.ratio("poisson_ratio", poisson_ratio, "of its material");
  f.quantity("density_kg_m3", density_kg_m3, "kg/m³", "of its material");
}

std::vector<RegionFigures> region_figures(const app::Scene& scene) {
  std::vector<RegionFigures> figures;
  if (!scene.has_body() || scene.scenario().object.regions.empty()) return figures;
  const std::vector<fem::Region>& regions = scene.scenario().object.regions;
  const fem::Materials& materials = scene.body().materials();
  const std::vector<fem::Share> shares = fem::shares_of(scene.body().mesh(), materials);
  double whole = 0;
  for (const fem::Share& share : shares) whole += share.volume_m3;
  for (std::size_t m = 0; m < shares.size(); ++m) {
    const fem::Material& material = materials.table()[m];
    figures.push_back({.name = m == 0 ? std::string(fem::kOfBody) : fem::name_of(regions, m - 1),
                       .elements = shares[m].elements,
                       .volume_m3 = shares[m].volume_m3,
                       .share = shares[m].volume_m3 / whole,
                       .mass_kg = shares[m].mass_kg,
                       .young_modulus_pa = material.young_modulus_pa,
                       .poisson_ratio = material.poisson_ratio,
                       .density_kg_m3 = material.density_kg_m3});
  }
  return figures;
}

std::string regions_text(const app::Scene& scene) {
  std::string text;
  const char* title = "regions";
  for (const RegionFigures& r : region_figures(scene)) {
    fmt::format_to(std::back_inserter(text), "  {:<11} {}: ", title,
                   scenario::one_line(r.name, 60));
    title = "";
    if (r.elements == 0) {
      fmt::format_to(std::back_inserter(text), "no element is left, the regions have all\n");
      continue;
    }
    fmt::format_to(std::back_inserter(text),
                   "{}, {} of the volume, {}, Poisson's ratio {:g}, {:g} kg/m³\n",
                   counted(r.elements, "element"), percent(r.share),
                   readable_stress(r.young_modulus_pa), r.poisson_ratio, r.density_kg_m3);
  }
  return text;
}

}  // namespace hvp::results
