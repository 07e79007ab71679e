#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/results/part_files.h"
#include "app/results/results_folder.h"
#include "app/results/vtu_files.h"
#include "models/config/input_error.h"
#include "models/fem/tissue.h"
#include "models/sparse/matrix_market.h"

namespace hvp::app {

namespace {

struct ExportArguments : ScenarioArguments {
  std::filesystem::path out;
};

void write_matrix(const std::filesystem::path& path, const sparse::BlockMatrix& matrix,
                  const std::string& comment) {
  std::ostringstream text;
  sparse::write_matrix_market(text, matrix, comment);
  results::write_through_part_file(path, text.str());
}

int export_command(const ExportArguments& arguments) {
  const LoadedScenario loaded = load(arguments);
  const Scenario& scenario = loaded.scenario;
  const Progress progress = make_progress(arguments.quiet);
  // No Scene is built, as a system for other tools need not fit the device.
  std::unique_ptr<fem::Body> body;
  std::unique_ptr<fem::Tissue> step;
  try {
    body = make_body(loaded.scenario, progress);
    // Where nothing is solved there is only the stiffness.
    if (scenario.has_memory() && scenario.host.solver != host::SolvedBy::steps) {
      step = make_tissue(scenario, *body);
    }
  } catch (const InputError& e) {
    throw loaded.document.complete(e);
  }
  end_progress(arguments.quiet);
  const std::filesystem::path& out = arguments.out;
  results::create_folder(out, "--out");
  const auto mass = scenario.dynamics ? scenario.dynamics->mass : fem::MassKind::lumped;
  write_matrix(out / "K.mtx", body->stiffness(), "stiffness, N/m, active nodes");
  write_matrix(out / "M.mtx", body->mass(mass), "mass, kg, active nodes");
  if (step) {
    write_matrix(out / "A.mtx", step->system(),
                 "effective matrix of the time step, N/m, active nodes");
  } else {
    std::filesystem::remove(out / "A.mtx");  // of an earlier export
  }
  std::ostringstream b;
  sparse::write_matrix_market(b, body->load(), "external force, N, active nodes");
  results::write_through_part_file(out / "b.mtx", b.str());
  const mesh::ElementShapes shapes = mesh::element_shapes(body->mesh());
  results::write_mesh(out / "mesh.vtu", body->mesh(),
                      {shapes.min_dihedral, shapes.aspect_ratio, body->materials().of_elements()});
  print("K.mtx, M.mtx, {}b.mtx and mesh.vtu in {}: {} nodes, {} in the system\n",
        step ? "A.mtx, " : "", out.string(), body->mesh().nodes.size(), body->active_nodes());
  return kHeld;
}

}  // namespace

void add_export(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command =
      app.add_subcommand("export", "write K, M, b (Matrix Market) and the mesh, for other tools");
  add_scenario_arguments(*command, *arguments);
  command->add_option("--out", arguments->out, "folder to write into")
      ->required()
      ->type_name("FOLDER");
  command->callback([arguments, &status] { status = export_command(*arguments); });
}

}  // namespace hvp::app
