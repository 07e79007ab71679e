#pragma once

#include <filesystem>
#include <vector>

namespace hvp::app {

// Times measured by the user, in s: the first column of a CSV file whose name ends in _s, _ms, _us
// or _ns. The first line has the names (files::CsvTable); columns beside it do not matter. Throws
// InputError (key "samples") with the line where a time is missing, is no number, or lies outside
// 0 to 1 s; where no column has such a name; and for a file without a time or of more than
// a million.
std::vector<double> read_samples(const std::filesystem::path& file);

}  // namespace hvp::app
