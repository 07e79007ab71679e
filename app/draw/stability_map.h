#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hvp::draw {

// How stiff a wall may be at each damping of it, before the loop that renders it is unstable: the
// Z-width (Colgate and Brown, IEEE ICRA 1994). Vectors of one size.
struct StabilityMap {
  std::string title;  // the file's first line where it begins with '#'; may be empty
  std::vector<double> damping_N_s_m;  // ascending
  std::vector<double> runs_N_m;       // the stiffest wall that a run of the platform was stable at
  std::vector<double> linear_N_m;     // the same by the eigenvalues of the linear loop
  std::vector<double> passive_N_m;    // up to here the wall is passive, whatever holds the device
};

inline constexpr std::size_t kMostDampings = 200;

// Reads the columns `damping_N_s_m`, `stiffness_max_N_m` (runs), `stiffness_linear_N_m` and
// `stiffness_passive_N_m`. Throws hvp::InputError with the line for a file that is missing, has no
// row or too many, lacks a column, holds a field that is not a finite number, or whose damping
// does not ascend.
StabilityMap read_stability_map(const std::filesystem::path& path);

}  // namespace hvp::draw
