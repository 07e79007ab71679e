#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/results/mesh_file.h"
#include "app/scenario/quantity.h"
#include "models/config/input_error.h"
#include "models/mesh/generate.h"
#include "models/mesh/quality.h"

namespace hvp::app {

namespace {

mesh::MeshSettings settings_of(const MeshArguments& a) {
  mesh::MeshSettings s;
  s.nodes = a.nodes;
  if (a.surface == "sphere" || a.surface == "box") {
    const bool sphere = a.surface == "sphere";
    s.shape = sphere ? mesh::MeshSettings::Shape::sphere : mesh::MeshSettings::Shape::box;
    if (!a.size.empty()) {
      const double size = scenario::parse_quantity(a.size, config::Dimension::length);
      if (!(size > 0)) throw InputError("--size: expected a length above zero, found " + a.size);
      s.radius = sphere ? size : s.radius;
      if (!sphere) s.size.setConstant(size);
    }
  } else {
    s.shape = mesh::MeshSettings::Shape::surface;
    s.surface = a.surface;
    s.surface_unit = scenario::parse_quantity(a.unit, config::Dimension::length);
    if (!(s.surface_unit > 0)) throw InputError("--unit: expected a length above zero");
  }
  return s;
}

}  // namespace

int mesh_command(const MeshArguments& arguments) {
  const Progress progress = make_progress(arguments.quiet);
  mesh::TetMesh mesh;
  try {
    mesh = mesh::generate(settings_of(arguments), progress);
  } catch (const InputError& e) {
    const bool about_file = e.key() == "surface" || e.key().empty();
    throw InputError(about_file ? std::string(e.what()) : "--" + e.key() + ": " + e.what());
  }
  end_progress(arguments.quiet);
  const mesh::Quality q = mesh::measure(mesh);
  fmt::print("nodes              {} ({} wanted)\n", q.nodes, arguments.nodes);
  fmt::print("tetrahedra         {}\n", q.tetrahedra);
  fmt::print("boundary triangles {}\n", q.boundary_triangles);
  fmt::print("volume             {:.6g} cm3\n", q.volume * 1e6);
  fmt::print("dihedral angles    {:.1f} to {:.1f} degrees, {} slivers\n", q.min_dihedral,
             q.max_dihedral, q.slivers);
  fmt::print("aspect ratio       at most {:.2f} (longest over shortest edge)\n",
             q.max_aspect_ratio);
  fmt::print("smallest det J     {:.4g} mm3\n", q.min_det_jacobian * 1e9);
  fmt::print("non-zeros a row    {:.1f} on average, {} at most\n\n", q.mean_row_nonzeros,
             q.max_row_nonzeros);
  fmt::print("{}", mesh::draw_dihedral_histogram(q));
  if (!arguments.out.empty()) {
    if (arguments.out.has_parent_path()) {
      std::filesystem::create_directories(arguments.out.parent_path());
    }
    const mesh::ElementShapes shapes = mesh::element_shapes(mesh);
    results::write_mesh(arguments.out, mesh, {shapes.min_dihedral, shapes.aspect_ratio});
    fmt::print("\n{}\n", arguments.out.string());
  }
  return kHeld;
}

}  // namespace hvp::app
