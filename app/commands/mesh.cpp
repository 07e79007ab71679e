#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/commands/terminal.h"
#include "app/results/mesh_file.h"
#include "app/results/results_folder.h"
#include "app/scenario/message.h"
#include "app/scenario/quantity.h"
#include "app/scenario/toml_text.h"
#include "models/config/input_error.h"
#include "models/mesh/generate.h"
#include "models/mesh/quality.h"

namespace hvp::app {

namespace {

constexpr int kMostNodes = 1'000'000;  // as object.mesh.nodes

double length(const char* option, const std::string& text, const config::Range& range) {
  try {
    const double value = scenario::parse_quantity(text, config::Dimension::length);
    if (scenario::contains(range, value)) return value;
  } catch (const InputError& e) {
    throw InputError(fmt::format("{} {}: {}", option, scenario::one_line(text), e.what()));
  }
  throw InputError(fmt::format("{} {}: out of range: expected {}", option, scenario::one_line(text),
                               scenario::range_text(range, config::Dimension::length)));
}

mesh::MeshSettings settings_of(const MeshArguments& a) {
  mesh::MeshSettings s;
  if (a.nodes < 4 || a.nodes > kMostNodes) {
    throw InputError(fmt::format("--nodes {0}: out of range: expected from 4 to {1}, found {0}",
                                 a.nodes, kMostNodes));
  }
  s.nodes = a.nodes;
  if (a.surface == "sphere" || a.surface == "box") {
    const bool sphere = a.surface == "sphere";
    s.shape = sphere ? mesh::MeshSettings::Shape::sphere : mesh::MeshSettings::Shape::box;
    if (!a.unit.empty()) throw InputError("--unit belongs to a surface file only");
    if (!a.size.empty() && sphere) s.radius = length("--size", a.size, mesh::kBodyLength);
    if (!a.size.empty() && !sphere) s.size.setConstant(length("--size", a.size, mesh::kBodyLength));
  } else {
    s.shape = mesh::MeshSettings::Shape::surface;
    s.surface = config::File(a.surface);
    if (!a.size.empty()) throw InputError("--size belongs to sphere and box only");
    if (!a.unit.empty()) s.surface_unit = length("--unit", a.unit, mesh::kUnitLength);
  }
  return s;
}

// Before the work whose result would be lost.
void check_out(const std::filesystem::path& out) {
  if (out.empty()) return;
  if (out.extension() != ".vtu") {
    throw InputError(fmt::format("--out {}: expected a file that ends in .vtu", out.string()));
  }
  if (std::filesystem::is_directory(out)) {
    throw InputError(fmt::format("--out {}: is a folder: expected a file", out.string()));
  }
  if (out.has_parent_path()) results::create_folder(out.parent_path(), "--out");
}

// The file comes first, as in a compiler's messages, and once.
std::string about_surface(const std::string& surface, const std::string& message) {
  return message.find(surface) == std::string::npos ? surface + ": " + message : message;
}

}  // namespace

int mesh_command(const MeshArguments& arguments) {
  const Progress progress = make_progress(arguments.quiet);
  mesh::TetMesh mesh;
  const mesh::MeshSettings settings = settings_of(arguments);
  check_out(arguments.out);
  try {
    mesh = mesh::generate(settings, progress);
  } catch (const InputError& e) {
    if (e.key() == "nodes") {
      throw InputError(fmt::format("--nodes {}: {}", arguments.nodes, e.what()));
    }
    throw InputError(scenario::one_line(about_surface(arguments.surface, e.what()), 2000));
  }
  end_progress(arguments.quiet);
  const mesh::Quality q = mesh::measure(mesh);
  print("nodes              {} ({} wanted)\n", q.nodes, arguments.nodes);
  print("tetrahedra         {}\n", q.tetrahedra);
  print("boundary triangles {}\n", q.boundary_triangles);
  print("volume             {:.6g} cm3\n", q.volume * 1e6);
  print("dihedral angles    {:.1f} to {:.1f} degrees, {} slivers\n", q.min_dihedral, q.max_dihedral,
        q.slivers);
  print("aspect ratio       at most {:.2f} (longest over shortest edge)\n", q.max_aspect_ratio);
  print("smallest det J     {:.4g} mm3\n", q.min_det_jacobian * 1e9);
  print("non-zeros a row    {:.1f} on average, {} at most\n\n", q.mean_row_nonzeros,
        q.max_row_nonzeros);
  print("{}", mesh::draw_dihedral_histogram(q));
  if (!arguments.out.empty()) {
    const mesh::ElementShapes shapes = mesh::element_shapes(mesh);
    results::write_mesh(arguments.out, mesh, {shapes.min_dihedral, shapes.aspect_ratio});
    print("\n{}\n", arguments.out.string());
  }
  return kHeld;
}

}  // namespace hvp::app
