#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "models/config/figures.h"
#include "models/stability/flag.h"

// A run's flags, and the remedy that was tried for them.

namespace hvp::results {

// The names of the flags that are raised, in the flags' order.
std::vector<std::string> flag_names(stability::Flags flags);

// The flags of these names; unknown names are left out.
stability::Flags flags_named(const std::vector<std::string>& names);

// A list of {"flag", "meaning", "remedy"}, one entry for each flag that is raised.
nlohmann::ordered_json remedies_json(stability::Flags flags);

// A remedy that was tried before it is named.
struct TriedRemedy {
  std::vector<std::string> settings;  // "solver.method = \"jacobi-pcg\"", in the order to be set
  stability::Flags of;                // the flags that the run has
  stability::Flags left;              // the flags that it has with the settings
  bool whole_run = false;             // the run itself was repeated with it, as printed
  bool was_held = true;               // the run met its budgets
  bool held = true;                   // and with it, too
  std::string verdict;                // what it is called
  std::size_t frames = 0;             // frames of the run that were solved again with it
  int attempts = 0;                   // plans that were tried
  double median = 0;                  // ‖u − u_true‖/‖u_true‖ of those frames in contact
  double p95 = 0;
  bool fits = true;      // the words that it needs fit the device
  std::string shortage;  // what is missing where they do not fit
  // The run's worst latency and load, and those with the settings: of the whole run or, where it
  // was not repeated, by annotated costs of the frame's large steps.
  struct Cost {
    std::int64_t latency_ps = 0;
    std::int64_t load_ps = 0;
  };
  Cost before;
  Cost after;
  bool in_time = true;  // within the budget and the period, with a hundredth of each to spare

  bool works() const { return left.empty() && (held || !was_held); }
  stability::Flags taken_away() const { return stability::Flags(of.bits() & ~left.bits()); }

  void report(config::Figures& f) const;
};

// A setting as an argument of --set: "solver.method=jacobi-pcg".
std::string override_text(std::string_view setting);

// All settings: "--set solver.method=jacobi-pcg --set refinement.passes=2".
std::string override_line(const std::vector<std::string>& settings);

// The remedy's lines for the terminal, below the flags.
std::string remedy_text(const TriedRemedy& remedy);

}  // namespace hvp::results
