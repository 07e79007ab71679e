#include "app/scene/scene.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/devices/devices.h"
#include "app/mesh/sandboxed_mesh.h"
#include "app/scene/loaded_scenario.h"
#include "app/scene/scenario.h"
#include "models/accel/critical_path.h"
#include "models/config/input_error.h"
#include "models/host/dense_solve.h"
#include "models/host/reference_run.h"
#include "models/mesh/surface_check.h"
#include "models/time/picoseconds.h"
#include "vp/fpga/register_bank.h"
#include "vp/host/soft_body.h"

namespace hvp::app {

namespace {

void tell(const Progress& progress, std::string_view what) {
  if (progress) progress(what);
}

std::vector<int> anchored_nodes(const Scenario& s, const mesh::TetMesh& mesh) {
  std::vector<int> nodes;
  for (std::size_t i = 0; i < s.object.anchors.size(); ++i) {
    const std::vector<int> found = mesh::select_nodes(s.object.anchors[i].region, mesh);
    if (found.empty()) {
      throw InputError("object.anchor[" + std::to_string(i) + "]",
                       "no node of the mesh lies in this region; expected at least three that are "
                       "not on one line");
    }
    nodes.insert(nodes.end(), found.begin(), found.end());
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

fem::Materials materials(const Scenario& s, const mesh::TetMesh& mesh) {
  const std::vector<fem::Region>& regions = s.object.regions;
  std::vector<mesh::Surface> surfaces(regions.size());
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const mesh::Volume& volume = regions[i].volume;
    if (volume.shape != mesh::Volume::Shape::surface) continue;
    surfaces[i] = within(fmt::format("object.region[{}]", i), [&] {
      return mesh::check_surface(sandboxed_surface(volume.surface.path, volume.surface_unit));
    });
  }
  return within("object",
                [&] { return fem::materials_of(mesh, s.object.material, regions, surfaces); });
}

[[noreturn]] void refuse_body_of_wall() {
  throw InputError("wall", "the scenario has a wall and no body: expected one with [object]");
}

}  // namespace

std::unique_ptr<fem::Body> make_body(const Scenario& s, const Progress& progress) {
  if (s.wall) refuse_body_of_wall();
  tell(progress, "meshing");
  mesh::TetMesh mesh =
      within("object.mesh", [&] { return sandboxed_mesh(s.object.mesh, progress); });
  tell(progress, "assembling");
  const std::vector<int> anchored = anchored_nodes(s, mesh);
  const fem::Materials of_elements = materials(s, mesh);
  try {
    return std::make_unique<fem::Body>(std::move(mesh), of_elements, anchored,
                                       s.object.anchored_nodes, s.loads, s.object.elements);
  } catch (const InputError& e) {
    if (e.key().empty()) throw InputError("object.mesh", e.what());
    throw InputError((e.key() == "anchor" ? "object." : "loads.") + e.key(), e.what());
  }
}

Scene::Scene(const Scenario& scenario, accel::Device device, const Progress& progress,
             Limits limits)
    : scenario_(scenario), device_(std::move(device)) {
  if (scenario_.wall) {
    take_samples(scenario_);
  } else {
    build_body(progress, limits);
  }
}

void Scene::refuse_wall() { refuse_body_of_wall(); }

namespace {

// Who solves, with the nodes that contact can load or move: those of the surface.
host::SolverChoice solver_of(const Scenario& s, const fem::Body& body) {
  return {s.host.solver, s.host.precision, host::touchable_nodes(body),
          s.dynamics.has_value() || s.object.nonlinear()};
}

}  // namespace

std::unique_ptr<fem::Tissue> make_tissue(const Scenario& s, const fem::Body& body) {
  if (s.host.solver == host::SolvedBy::steps) {
    return tissue::make_explicit_tissue(body, s.object.model, s.contact.diagonal, *s.dynamics,
                                        s.budget.period_s, s.host.substeps);
  }
  return tissue::make_tissue(body, s.object.model, s.contact.diagonal, s.dynamics,
                             s.budget.period_s,
                             s.timing_only() ? host::Effort::counted : host::Effort::computed);
}

namespace {

std::unique_ptr<fem::ReferenceModel> reference_of_body(const Scene& scene,
                                                       std::optional<tissue::LawKind> law) {
  const Scenario& s = scene.scenario();
  tissue::Model model = s.object.model.value_or(tissue::Model{});
  model.kind = law.value_or(s.object.law());
  if (law) model.springs = false;
  if (const fem::ExplicitSteps* steps = scene.computation().explicit_steps()) {
    return tissue::make_fine_steps(scene.body(), model, *s.dynamics, s.budget.period_s,
                                   steps->substeps(), s.probes.size());
  }
  if (!model.linear()) {
    return tissue::make_reference(scene.body(), model, s.dynamics, s.budget.period_s,
                                  s.probes.size());
  }
  const sparse::BlockMatrix& matrix = scene.computation().matrix();
  return std::make_unique<host::ReferenceRun>(scene.body(), s.dynamics, s.budget.period_s, matrix,
                                              matrix, s.probes.size());
}

}  // namespace

std::unique_ptr<fem::ReferenceModel> make_reference(const Scene& scene,
                                                    std::optional<tissue::LawKind> law) {
  return with_own_contact(scene, reference_of_body(scene, law));
}

std::unique_ptr<fem::ReferenceModel> with_own_contact(const Scene& scene,
                                                      std::unique_ptr<fem::ReferenceModel> body) {
  if (scene.glide() == nullptr) return body;
  return std::make_unique<host::GlidingReference>(
      std::move(body), std::make_unique<host::GlidingContact>(scene.body(), *scene.glide()));
}

vp::SoftBody soft_body(Scene& scene) {
  return {scene.body(), scene.computation(), scene.contacts(), scene.glide()};
}

void Scene::build_body(const Progress& progress, Limits limits) {
  if (limits == Limits::refused) require_plausible_size(scenario_, device_, progress);
  body_ = make_body(scenario_, progress);
  take_samples(scenario_);
  const Scenario& s = scenario_;
  quality_ = mesh::measure(body_->mesh());
  std::unique_ptr<fem::Tissue> tissue = make_tissue(s, *body_);
  computation_ = within("solver", [&] {
    return std::make_unique<host::FrameComputation>(
        std::move(tissue), s.solver, s.refinement, solver_of(s, *body_),
        s.timing_only() ? host::Effort::counted : host::Effort::computed, s.object.renewal());
  });
  if (s.host.solver == host::SolvedBy::board) {
    within("accelerator", [&] {
      const auto& matrix = computation_->matrix();
      const accel::WordLengths words = accel::word_lengths(computation_->board().settings());
      accel::Pattern pattern_of_matrix = accel::pattern_of(matrix.row_begin, matrix.column);
      if (s.accelerator.clock_hz == 0) {
        scenario_.accelerator.clock_hz =
            accel::fastest_clock({device_, s.accelerator, words, pattern_of_matrix.nodes()});
      }
      accel::require_division(s.accelerator, computation_->board().settings());
      board_.emplace(s.accelerator, std::move(pattern_of_matrix));
      usage_ = accel::board_usage(device_, s.accelerator, words, *board_);
      if (limits == Limits::reported) return;
      require_fit();
      accel::require_clock({device_, s.accelerator, words, pattern().nodes()});
    });
    if (limits == Limits::refused) require_room_in_registers();
  }

  // A node with a prescribed displacement, by an anchor or a load, cannot follow the probe.
  std::vector<int> held;
  for (int node = 0; node < static_cast<int>(body_->mesh().nodes.size()); ++node) {
    if (body_->held(node)) held.push_back(node);
  }
  contacts_ = within("contact", [&] {
    return std::make_unique<collision::ContactSearch>(body_->mesh(), held, s.contact.search);
  });
  if (s.contact.search.glides()) {
    tell(progress, "solving for the compliance of the surface");
    std::vector<double> radii;
    for (const auto& probe : s.probes) radii.push_back(probe.radius);
    glide_ = within("contact", [&] {
      return std::make_unique<host::GlideTables>(*body_, computation_->matrix(),
                                                 s.dynamics.has_value(), computation_->linear(),
                                                 s.contact.search, radii);
    });
    if (glide_->free_displacement.empty()) computation_->expect_to_go_on();
  }
  if (s.spectrum) {
    tell(progress, "bounding the spectrum");
    // The words are asked for whoever solves.
    spectrum_ = fixed::bound_spectrum(computation_->matrix(),
                                      computation_->has_board()
                                          ? computation_->board().words()
                                          : fixed::prepare(computation_->matrix(), s.solver),
                                      *s.spectrum);
  }
  locking_ = fem::measure_locking(body_->mesh(), body_->materials(), s.object.elements);
}

void Scene::require_fit() const {
  if (usage_.fits()) return;
  const accel::WordLengths words = accel::word_lengths(computation_->board().settings());
  // The device's limit counts the nodes of the system, the scenario those of the mesh.
  accel::require_board_fit(device_, scenario_.accelerator, words, *board_, devices::all_built_in(),
                           static_cast<int>(quality_.nodes));
}

// Refuses a system that is too large for the board's registers.
void Scene::require_room_in_registers() const {
  const vp::Capacity room;
  const sparse::BlockMatrix& matrix = computation_->matrix();
  const auto rows = static_cast<std::int64_t>(matrix.row_begin.size()) - 1;
  std::int64_t longest = 0;
  for (std::size_t row = 0; row + 1 < matrix.row_begin.size(); ++row) {
    longest = std::max<std::int64_t>(longest, matrix.row_begin[row + 1] - matrix.row_begin[row]);
  }
  const auto blocks = static_cast<std::int64_t>(matrix.blocks());
  if (rows <= room.nodes && longest <= room.row_blocks && blocks <= room.blocks) return;
  throw InputError(
      "object.mesh.nodes",
      fmt::format("the board's registers have room for {} nodes, {} blocks in a row and {} blocks "
                  "(docs/registers.md), the system has {}, {} and {}: expected {}",
                  room.nodes, room.row_blocks, room.blocks, rows, longest, blocks,
                  longest > room.row_blocks ? "another number of nodes" : "a coarser mesh"));
}

std::string Scene::board_name() const {
  const std::optional<accel::Several>& several = scenario_.accelerator.several;
  return several ? fmt::format("{} × {}", several->devices, device_.name) : device_.name;
}

const accel::BoardClocks& Scene::board() const {
  if (!has_body()) refuse_wall();
  if (!board_) throw InputError("host.solver", "the host solves: there is no board to ask about");
  return *board_;
}

accel::SolveCycles Scene::solve_cycles() const {
  if (!board_) return {};
  return board_->solve(accel::longest_solve(computation_->board().settings()));
}

vp::PlatformSettings platform_settings(const Scene& scene, const std::string& waveform_file) {
  const Scenario& s = scene.scenario();
  vp::PlatformSettings p(s);
  p.period = to_picoseconds(s.budget.period_s);
  // A force is due at the next tick, or with a pipeline that many ticks later.
  p.budget = (1 + s.host.pipeline_depth) * p.period;
  if (!scene.has_body()) return p;
  if (scene.has_board()) p.solver = scene.computation().board().settings();
  if (const std::optional<WaveformSettings>& shown = s.output.waveform) {
    p.waveform = {waveform_file, shown->first_frame, shown->frames};
  }
  return p;
}

}  // namespace hvp::app
