#pragma once

#include <optional>

#include "models/accel/architecture.h"
#include "models/config/declaration.h"
#include "models/fixed/settings.h"
#include "models/host/refinement.h"
#include "models/sparse/spectrum.h"

namespace hvp::app {

// What --set reaches in `hvp solve`: the tables of a scenario that a single system has a use for,
// with the defaults of this command.
struct SolveSettings {
  SolveSettings();

  fixed::Settings solver;
  std::optional<host::Refinement> refinement;
  accel::Architecture accelerator;
  std::optional<sparse::SpectrumSettings> spectrum;

  void declare(config::Visitor& v);
  void check() const;
};

}  // namespace hvp::app
