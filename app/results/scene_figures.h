#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/results/engine_clocks.h"
#include "app/scene/scene.h"
#include "models/accel/cycles.h"
#include "models/accel/memory.h"
#include "models/config/figures.h"
#include "models/fixed/spectrum.h"
#include "models/mesh/quality.h"
#include "vp/fidelity.h"

namespace hvp::results {

// The body and its system: the table `mesh`.
struct BodyFigures {
  mesh::Quality mesh;
  int active_nodes = 0;
  std::size_t matrix_blocks = 0;

  void report(config::Figures& f) const;
};

// What was simulated, as results repeat it.
struct SceneFigures {
  std::string title;
  std::int64_t frames = 0;   // that the scenario asks for
  bool timing_only = false;  // nobody computed the numbers
  std::string solver;
  std::vector<std::string> effects;
  vp::Fidelity fidelity;
  bool has_board = false;
  std::vector<accel::Resource> resources;
  std::optional<fixed::SystemSpectrum> condition;
  std::optional<BodyFigures> body;  // none where a wall stands in its place

  // Tables of summary.json.
  void report_resources(config::Figures& f) const;
  void report_fidelity(config::Figures& f) const;
};

SceneFigures scene_figures(const app::Scene& scene);

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

  // Of the longest solve where an engine counted it, else by the closed form.
  std::int64_t solve_cycles() const { return engine ? engine->engine : closed_form.total(); }
  void report(config::Figures& f) const;
};

// `board`: the one that ran. Absent where the host solves.
std::optional<AcceleratorFigures> accelerator_figures(const app::Scene& scene,
                                                      const vp::Accelerator* board);

}  // namespace hvp::results
