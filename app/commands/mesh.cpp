#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/mesh/sandboxed_mesh.h"
#include "app/results/number_text.h"
#include "app/results/part_files.h"
#include "app/results/results_folder.h"
#include "app/results/vtu_files.h"
#include "app/scenario/message.h"
#include "app/scenario/quantity.h"
#include "app/scenario/toml_text.h"
#include "models/config/input_error.h"
#include "models/fem/quadratic_element.h"
#include "models/mesh/polygon_files.h"
#include "models/mesh/quality.h"
#include "models/mesh/surface_repair.h"

namespace hvp::app {

namespace {

struct MeshArguments {
  std::string surface;       // a file, "sphere" or "box"
  std::string unit;          // of a file; empty: the default, like size
  std::string size;          // of a sphere or box
  std::optional<int> nodes;  // absent: kNodes
  std::string elements = "linear";
  std::filesystem::path out;
  std::filesystem::path repair;  // a file for a closed surface; empty: none is made
  std::string detail;            // of that; empty: the default
  bool quiet = false;
};

constexpr int kNodes = 500;
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
  const int nodes = a.nodes.value_or(kNodes);
  if (nodes < 4 || nodes > kMostNodes) {
    throw InputError(fmt::format("--nodes {0}: out of range: expected from 4 to {1}, found {0}",
                                 nodes, kMostNodes));
  }
  s.nodes = nodes;
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

constexpr config::Range kDetail = config::between(1e-9, 1e3);  // m

// Checks what belongs to a repair, and what does not.
void check_repair(const MeshArguments& a) {
  if (a.repair.empty()) {
    if (!a.detail.empty()) throw InputError("--detail belongs to --repair only");
    return;
  }
  const std::string shown = scenario::one_line(a.repair.string());
  if (a.repair.extension() != ".obj") {
    throw InputError(fmt::format("--repair {}: expected a file that ends in .obj", shown));
  }
  if (a.surface == "sphere" || a.surface == "box") {
    throw InputError("--repair belongs to a surface file only");
  }
  std::error_code none;
  if (std::filesystem::equivalent(a.surface, a.repair, none)) {
    throw InputError(
        fmt::format("--repair {}: is the surface itself: expected another file", shown));
  }
  for (const auto& [option, given] :
       {std::pair("--out", !a.out.empty()), std::pair("--nodes", a.nodes.has_value())}) {
    if (given) {
      throw InputError(
          fmt::format("{}: a repair makes no tetrahedra: expected --repair alone", option));
    }
  }
  if (a.repair.has_parent_path()) results::create_folder(a.repair.parent_path(), "--repair");
}

// Puts the file in front, as in a compiler's messages, unless the message names it already.
std::string about_surface(const std::string& surface, const std::string& message) {
  return message.find(surface) == std::string::npos ? surface + ": " + message : message;
}

// The old volume, and why it is less now where no part of the old surface was inside: a grid rounds
// thin walls off.
std::string volume_before(const mesh::RepairedSurface& repaired) {
  if (!repaired.old_volume) return {};
  constexpr double kLost = 0.05;
  const double kept = repaired.volume + repaired.dropped_volume;
  const bool thinner = repaired.left_share == 0 && kept < (1 - kLost) * *repaired.old_volume;
  return fmt::format(
      ", of {:.6g} cm3 before{}", *repaired.old_volume * 1e6,
      thinner ? ": walls are thinner than two details, a smaller --detail keeps them" : "");
}

// Writes the closed surface and says what it changed.
int repair_command(const MeshArguments& arguments, const mesh::MeshSettings& settings) {
  const Progress progress = make_progress(arguments.quiet);
  mesh::RepairedSurface repaired;
  const double detail =
      arguments.detail.empty() ? 0 : length("--detail", arguments.detail, kDetail);
  try {
    repaired = sandboxed_repair(settings.surface.path, settings.surface_unit, detail, progress);
  } catch (const InputError& e) {
    if (e.key() == "detail") throw InputError(fmt::format("--detail: {}", e.what()));
    throw InputError(scenario::one_line(about_surface(arguments.surface, e.what()), 2000));
  }
  end_progress(arguments.quiet);
  results::write_through_part_file(arguments.repair,
                                   mesh::obj_text(repaired.surface, settings.surface_unit));
  print("points             {}, of {} triangles\n", repaired.surface.points.size(),
        repaired.surface.triangles.size());
  print("volume             {:.6g} cm3{}\n", repaired.volume * 1e6, volume_before(repaired));
  print("detail             {:.4g} mm: what is smaller is smoothed away, and holes are closed\n",
        1e3 * repaired.detail);
  print("moved              at most {:.4g} mm from the old surface\n", 1e3 * repaired.moved);
  print(
      "left out           {:.3g} % of the old surface: more than two details away from the new "
      "one\n",
      100 * repaired.left_share);
  if (repaired.dropped_shells > 0) {
    print("dropped            {} beside the largest, of {:.4g} cm3\n",
          results::counted(repaired.dropped_shells, "shell"), repaired.dropped_volume * 1e6);
  }
  print("\n{}\n", arguments.repair.string());
  return kHeld;
}

int mesh_command(const MeshArguments& arguments) {
  check_repair(arguments);
  if (!arguments.repair.empty()) return repair_command(arguments, settings_of(arguments));
  const Progress progress = make_progress(arguments.quiet);
  mesh::TetMesh mesh;
  const mesh::MeshSettings settings = settings_of(arguments);
  check_out(arguments.out);
  try {
    mesh = sandboxed_mesh(settings, progress);
  } catch (const InputError& e) {
    if (e.key() == "nodes") {
      throw InputError(fmt::format("--nodes {}: {}", settings.nodes, e.what()));
    }
    throw InputError(scenario::one_line(about_surface(arguments.surface, e.what()), 2000));
  }
  end_progress(arguments.quiet);
  const mesh::Quality q = mesh::measure(mesh);
  print("nodes              {} ({} wanted)\n", q.nodes, settings.nodes);
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
  command
      ->add_option("--repair", arguments->repair,
                   "write a closed surface in place of one that crosses itself or has holes, and "
                   "say what it changed")
      ->type_name("FILE.obj");
  command
      ->add_option("--detail", arguments->detail,
                   "the smallest that a repair keeps, a hundredth of the diagonal by default")
      ->type_name("LENGTH");
  command->add_flag("--quiet", arguments->quiet, "no progress on the terminal");
  command->callback([arguments, &status] { status = mesh_command(*arguments); });
}

}  // namespace hvp::app
