#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/results/regions.h"
#include "models/accel/cycles.h"
#include "models/accel/memory.h"
#include "models/config/figures.h"
#include "models/fixed/spectrum.h"
#include "models/mesh/quality.h"
#include "vp/fidelity.h"
#include "vp/fpga/rtl/compared.h"

namespace hvp::app {
struct Scenario;
class Scene;
}  // namespace hvp::app
namespace hvp::vp {
class Accelerator;
struct EngineSolve;
}  // namespace hvp::vp

// The figures of scene and accelerator, and the accelerator's texts for the terminal.

namespace hvp::results {

// The clocks of one phase of a solve as the engine took them, and by the closed form of
// docs/accelerator.md for the same work.
struct PhaseClocks {
  const char* name = "";   // in summary.json
  const char* title = "";  // on the terminal
  std::int64_t engine = 0;
  std::int64_t closed_form = 0;
};

// The longest solve of a run at a level that has an engine.
struct EngineClocks {
  std::int64_t engine = 0;
  std::int64_t closed_form = 0;
  std::int64_t iterations = 0;
  std::array<PhaseClocks, 7> phases{};

  // The relative deviation of the closed form from the engine.
  double deviation() const {
    return static_cast<double>(closed_form - engine) / static_cast<double>(engine);
  }
};

// The phases of each sum to its clocks. `closed_form` is that of solve.work.
EngineClocks engine_clocks(const vp::EngineSolve& solve, const accel::SolveCycles& closed_form);

// The body and its system: the table `mesh`.
struct BodyFigures {
  mesh::Quality mesh;
  int active_nodes = 0;
  std::size_t matrix_blocks = 0;
  std::vector<RegionFigures> regions;  // empty without [[object.region]]

  void report(config::Figures& f) const;
};

// The figures of the scene that results repeat.
struct SceneFigures {
  std::string title;
  std::int64_t frames = 0;   // that the scenario asks for
  bool timing_only = false;  // no numbers were computed
  std::string solver;
  std::vector<std::string> effects;
  vp::Fidelity fidelity;
  bool has_board = false;
  std::vector<accel::Resource> resources;
  std::optional<fixed::SystemSpectrum> condition;
  std::optional<BodyFigures> body;  // absent where a wall replaces the body

  // Tables of summary.json.
  void report_resources(config::Figures& f) const;
  void report_fidelity(config::Figures& f) const;
};
SceneFigures scene_figures(const app::Scene& scene);

// The names of the scenario's tables that are effects.
std::vector<std::string> effects(const app::Scenario& scenario);

// The solver board: the table `accelerator`.
struct AcceleratorFigures {
  std::string device;
  accel::SolveCycles closed_form;  // of a solve that makes all its iterations
  std::int64_t clock_period_ps = 0;
  std::int64_t illegal_accesses = 0;
  std::optional<EngineClocks> engine;  // where the fidelity has one and it solved something
  struct Several {
    std::size_t devices = 0;
    std::int64_t link_cycles = 0;
  };
  std::optional<Several> several;
  // At the level rtl, for the terminal: the results are those of cycle-accurate.
  std::optional<vp::rtl::Compared> compared;

  // The clocks of the longest solve where an engine counted it, else by the closed form.
  std::int64_t solve_cycles() const { return engine ? engine->engine : closed_form.total(); }
  void report(config::Figures& f) const;
};
// `board` is the accelerator that ran, or null. Absent where the host solves.
std::optional<AcceleratorFigures> accelerator_figures(const app::Scene& scene,
                                                      const vp::Accelerator* board);

// Clocks of a solve by phase, by the closed form; the groups are those of docs/accelerator.md.
std::string clocks_text(const app::Scene& scene);

// The memory blocks and multipliers of the device: available, used, and for which purpose.
std::string resources_text(const app::Scene& scene);

// The devices' shares of the rows, the cost of their links and the speed-up of more devices; empty
// where the scenario has one device.
std::string several_text(const app::Scene& scene);

}  // namespace hvp::results
