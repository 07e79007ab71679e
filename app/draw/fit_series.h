#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hvp::draw {

// A log and a model of it, a value a sample: vectors of one size. NaN between stretches of the log
// that are not connected.
struct FitSeries {
  std::string title;  // the file's first line where it begins with '#'; may be empty
  std::vector<double> x;
  std::vector<double> observed;
  std::vector<double> modelled;
  std::vector<double> residual;
};

// Reads the columns `x`, `observed`, `modelled` and `residual`; a row of empty fields parts two
// stretches. Throws hvp::InputError with the line for a file that is missing, has no row, lacks a
// column or holds a field that is not a number, and where x goes back.
FitSeries read_fit(const std::filesystem::path& path);

}  // namespace hvp::draw
