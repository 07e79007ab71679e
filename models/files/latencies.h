#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hvp::files {

// Latencies that somebody measured, each with how often it was seen.
struct Latencies {
  struct Entry {
    double seconds = 0;
    std::int64_t count = 1;
  };
  std::vector<Entry> entries;       // in the file's order
  bool whole_microseconds = false;  // they were rounded down to them, by cyclictest
  std::int64_t overflows = 0;       // latencies beyond the last entry
  std::optional<double> longest;    // s, as the file states it
  std::vector<std::string> warnings;
};

// Reads the three forms of a table of latencies, with one meaning wherever hvp takes one.
//
// The output of `cyclictest -h` or `-H`: lines of a latency in us and a count for each processor,
// which are added up, and comments with #, among them the overflows and the largest latencies.
//
// The output of `rtla timerlat hist` (timerlat.h).
//
// A CSV file (csv.h) with the names of its columns above: one column of latencies, whose name ends
// in _s, _ms, _us or _ns; with it may stand `count`, how often the latency was seen, and
// `time_s` (or _ms, _us, _ns), when. A file with two columns of times has to call one of them
// latency. Other columns are refused, as they may mean that a row is not what it is taken for.
//
// Throws InputError with the line that is to blame: no numbers, a latency that is missing or
// outside 0 to 1 s, a count that is no whole number from zero on, latencies of cyclictest that do
// not grow, and none at all.
Latencies read_latencies(std::string_view text);

// The same of a file of at most 64 MB; errors begin with its name.
Latencies read_latencies_file(const std::filesystem::path& file);

}  // namespace hvp::files
