#include <sstream>

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/results/mesh_file.h"
#include "app/results/part_file.h"
#include "models/config/input_error.h"
#include "models/sparse/matrix_market.h"

namespace hvp::app {

namespace {

void write_matrix(const std::filesystem::path& path, const sparse::BlockMatrix& matrix,
                  const std::string& comment) {
  std::ostringstream text;
  sparse::write_matrix_market(text, matrix, comment);
  results::write_through_part_file(path, text.str());
}

}  // namespace

int export_command(const ExportArguments& arguments) {
  const LoadedScenario loaded = load(arguments);
  const Progress progress = make_progress(arguments.quiet);
  try {
    const Scene scene(loaded.openable, loaded.scenario, progress);
    end_progress(arguments.quiet);
    const std::filesystem::path& out = arguments.out;
    std::filesystem::create_directories(out);
    const fem::Body& body = scene.body();
    const auto kind =
        loaded.scenario.dynamics ? loaded.scenario.dynamics->mass : fem::MassKind::lumped;
    write_matrix(out / "K.mtx", body.stiffness(), "stiffness, N/m, active nodes");
    write_matrix(out / "M.mtx", body.mass(kind), "mass, kg, active nodes");
    if (scene.computation().dynamic()) {
      write_matrix(out / "A.mtx", scene.computation().matrix(),
                   "effective matrix of the time step, N/m, active nodes");
    }
    std::ostringstream b;
    sparse::write_matrix_market(b, body.load(), "external force, N, active nodes");
    results::write_through_part_file(out / "b.mtx", b.str());
    const mesh::ElementShapes shapes = mesh::element_shapes(body.mesh());
    results::write_mesh(out / "mesh.vtu", body.mesh(), {shapes.min_dihedral, shapes.aspect_ratio});
    fmt::print("K.mtx, M.mtx, {}b.mtx and mesh.vtu in {}: {} nodes, {} in the system\n",
               scene.computation().dynamic() ? "A.mtx, " : "", out.string(),
               body.mesh().nodes.size(), body.active_nodes());
  } catch (const InputError& e) {
    throw loaded.document.complete(e);
  }
  return kHeld;
}

}  // namespace hvp::app
