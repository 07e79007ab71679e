#pragma once

#include <filesystem>
#include <string>
#include <vector>

// Files of columns that a fit and a search for stability write.

namespace hvp::draw {

// A log and a model of it, a value a sample: vectors of one size. A NaN separates stretches of the
// log that are not connected.
struct FitSeries {
  std::string title;  // the file's first line where it begins with '#'; may be empty
  std::vector<double> x;
  std::vector<double> observed;
  std::vector<double> modelled;
  std::vector<double> residual;
};

// Reads the columns `x`, `observed`, `modelled` and `residual`; a row of empty fields separates
// two stretches. Throws hvp::InputError with the line for a file that is missing, has no row, lacks
// a column or has a field that is not a number, and where x goes back.
FitSeries read_fit(const std::filesystem::path& path);

// The largest stiffness of a wall, at each damping of the wall, with which the loop that renders it
// is stable: the Z-width (Colgate and Brown, IEEE ICRA 1994). Vectors of one size.
struct StabilityMap {
  std::string title;  // the file's first line where it begins with '#'; may be empty
  std::vector<double> damping_N_s_m;  // ascending
  std::vector<double> runs_N_m;     // the stiffest wall with which a run of the platform was stable
  std::vector<double> linear_N_m;   // the stiffest wall by the eigenvalues of the linear loop
  std::vector<double> passive_N_m;  // the stiffest wall that is passive, whoever grips the device
};

inline constexpr std::size_t kMostDampings = 200;

// Reads the columns `damping_N_s_m`, `stiffness_max_N_m` (runs), `stiffness_linear_N_m` and
// `stiffness_passive_N_m`. Throws hvp::InputError with the line for a file that is missing, has no
// row or too many, lacks a column, has a field that is not a finite number, or whose damping
// does not ascend.
StabilityMap read_stability_map(const std::filesystem::path& path);

}  // namespace hvp::draw
