#pragma once

#include <filesystem>
#include <vector>

namespace hvp::app {

// Times measured by the user, in s: the first column of a CSV file whose name ends in _s, _ms, _us
// or _ns. The first line has the names; empty lines and columns beside it do not matter. Throws
// InputError (key "samples") with the line where a time is missing, is no number, or lies outside
// 0 to 1 s; where no column has such a name; and for a file without a time, of more than a
// million or of more than 256 MiB.
std::vector<double> read_samples(const std::filesystem::path& file);

}  // namespace hvp::app
