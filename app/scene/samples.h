#pragma once

#include <filesystem>
#include <vector>

namespace hvp::app {

// Reads times that the user measured, in s, from the first column of a CSV file whose name ends in
// _s, _ms, _us or _ns. The first line contains the names (files::CsvTable); other columns are
// ignored. Throws InputError (key "samples") with the line if a time is missing, not a number, or
// outside 0 to 1 s; also if no column has such a name, and if the file has no time or more than a
// million.
std::vector<double> read_samples(const std::filesystem::path& file);

}  // namespace hvp::app
