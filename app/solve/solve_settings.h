#pragma once

#include <optional>

#include "models/accel/architecture.h"
#include "models/accel/device.h"
#include "models/config/declaration.h"
#include "models/fixed/settings.h"
#include "models/host/refinement.h"
#include "models/sparse/spectrum.h"

namespace hvp::app {

// What --set reaches in `hvp solve`: the tables of a scenario that a single system has a use for,
// with the defaults of this command. The architecture is that of scenarios/thesis-pcg.toml, with
// which Jacobi-PCG fits an EP2S60 beside the thesis' 500 nodes; that of plain CG has too many
// multipliers for any system.
struct SolveSettings {
  SolveSettings();
  // The device is known: z and the inverse diagonal go into its M512 blocks, where it has some and
  // the user has not chosen.
  void choose_preconditioner_memory(const accel::Device& device);

  fixed::Settings solver;
  std::optional<host::Refinement> refinement;
  accel::Architecture accelerator;
  std::optional<sparse::SpectrumSettings> spectrum;

  void declare(config::Visitor& v);
  void check() const;
};

}  // namespace hvp::app
