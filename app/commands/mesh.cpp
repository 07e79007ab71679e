#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/mesh/sandboxed_mesh.h"
#include "app/results/results_folder.h"
#include "app/results/vtu_files.h"
#include "app/scenario/message.h"
#include "app/scenario/quantity.h"
#include "app/scenario/toml_text.h"
#include "models/config/input_error.h"
#include "models/fem/quadratic_element.h"
#include "models/mesh/quality.h"

namespace hvp::app {

namespace {

struct MeshArguments {
  std::string surface;  // a file, "sphere" or "box"
  std::string unit;     // of a file; empty: the default, like size
  std::string size;     // of a sphere or box
  int nodes = 500;
  std::string elements = "linear";
  std::filesystem::path out;
  bool quiet = false;
};

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
  const auto& kinds = fem::elements_names();
  const auto kind = std::ranges::find(kinds, a.elements, [](const auto& k) { return k.first; });
  if (kind == kinds.end()) {
    throw InputError(
        fmt::format("--elements {}: expected linear, quadratic or quadratic-mean-dilatation",
                    scenario::one_line(a.elements)));
  }
  s.quadratic = kind->second != fem::Elements::linear;
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

// Checks the output file before the work, so that no result is lost.
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

// Puts the file in front, as in a compiler's messages, unless the message names it already.
std::string about_surface(const std::string& surface, const std::string& message) {
  return message.find(surface) == std::string::npos ? surface + ": " + message : message;
}

int mesh_command(const MeshArguments& arguments) {
  const Progress progress = make_progress(arguments.quiet);
  mesh::TetMesh mesh;
  const mesh::MeshSettings settings = settings_of(arguments);
  check_out(arguments.out);
  try {
    mesh = sandboxed_mesh(settings, progress);
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

}  // namespace

void add_mesh(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<MeshArguments>();
  CLI::App* command =
      app.add_subcommand("mesh", "fill a surface with tetrahedra and show their quality");
  command
      ->add_option("surface", arguments->surface,
                   "a file (STL, PLY, OBJ, VTP or VTU), or the word sphere or box")
      ->required()
      ->type_name("SURFACE");
  command->add_option("--nodes", arguments->nodes, "how many nodes are wanted, 500 by default")
      ->type_name("N");
  command
      ->add_option("--elements", arguments->elements,
                   "linear, with four nodes, or quadratic, with a node on each edge too, as "
                   "quadratic-mean-dilatation has them")
      ->type_name("KIND");
  command
      ->add_option("--unit", arguments->unit, "length of one unit of the file, \"1 mm\" by default")
      ->type_name("LENGTH");
  command
      ->add_option("--size", arguments->size,
                   "radius of the sphere, \"50 mm\" by default, or edge of the box, \"100 mm\"")
      ->type_name("LENGTH");
  command->add_option("--out", arguments->out, "write the mesh into this file, for ParaView")
      ->type_name("FILE.vtu");
  command->add_flag("--quiet", arguments->quiet, "no progress on the terminal");
  command->callback([arguments, &status] { status = mesh_command(*arguments); });
}

}  // namespace hvp::app
