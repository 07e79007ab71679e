#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "models/config/figures.h"
#include "models/stability/flag.h"

namespace hvp::results {

// A remedy that was tried before it is named.
struct TriedRemedy {
  std::vector<std::string> settings;  // "solver.method = \"jacobi-pcg\"", in the order to be set
  stability::Flags of;                // that it was looked for
  stability::Flags left;              // that it leaves; empty: it works
  std::size_t frames = 0;             // of the run, solved again with it
  int attempts = 0;                   // plans that were tried
  double median = 0;                  // ‖u − u_true‖/‖u_true‖ of those frames in contact
  double p95 = 0;
  // What the words need of the device.
  bool fits = true;
  std::string shortage;  // where it does not
  // The run's worst latency and load, and what they come to with the frame's large steps as they
  // are with the settings, by annotated costs.
  struct Cost {
    std::int64_t latency_ps = 0;
    std::int64_t load_ps = 0;
  };
  Cost before;
  Cost after;
  bool in_time = true;  // within the budget and the period, with a hundredth of each to spare

  void report(config::Figures& f) const;
};

// As an argument of --set: "solver.method=jacobi-pcg".
std::string override_text(std::string_view setting);
// All of them: "--set solver.method=jacobi-pcg --set refinement.passes=2".
std::string override_line(const std::vector<std::string>& settings);

// For the terminal, below the flags.
std::string remedy_text(const TriedRemedy& remedy);
// Of a single system: error_rel in place of what only a run has.
nlohmann::ordered_json solve_remedy_json(const TriedRemedy& remedy);

}  // namespace hvp::results
