#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace hvp::app {

// Times that the user measured, s, and how often each was seen.
struct Samples {
  std::vector<double> times_s;
  std::vector<std::int64_t> counts;  // empty: each once
};

// Reads a table of latencies (files::read_latencies), of at most a million entries. What lay beyond
// the histogram counts as the longest latency that the file states. Throws InputError (key
// "samples") as read_latencies() does, for more entries, and where the file does not state it.
Samples read_samples(const std::filesystem::path& file);

}  // namespace hvp::app
