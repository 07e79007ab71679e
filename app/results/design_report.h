#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/design/design_figures.h"
#include "models/config/figures.h"

namespace hvp::results {

// The declared figures that `hvp device --json` prints.
struct DesignReport {
  std::string title;
  std::string device;
  std::string family;
  double clock_hz = 0;
  bool clock_is_reached = true;
  int devices = 1;
  struct Links {
    std::int64_t clocks_an_iteration = 0;
    std::int64_t clocks_a_solve = 0;
  };
  std::optional<Links> links;  // between several devices
  app::DesignFigures figures;

  void report(config::Figures& f) const;
};
DesignReport design_report(const app::Scene& scene, const app::DesignFigures& figures);

// The text that `hvp device` prints.
std::string design_text(const app::Scene& scene, const app::DesignFigures& figures);

}  // namespace hvp::results
