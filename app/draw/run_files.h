#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hvp::draw {

// A row of frames.csv. Times in microseconds, as in the file.
struct FrameRow {
  long frame = 0;
  double latency_us = 0.0;  // NaN where the tick was skipped: the field is empty
  bool in_time = true;
  int contact_node = -1;
};

struct Contribution {
  std::string part;
  std::string phase;
  double us = 0.0;
};

// What summary.json says of the deadline.
struct Deadline {
  double period_us = 0.0;
  double worst_us = 0.0;
  double budget_us = 0.0;  // the period where the file states none
  std::vector<Contribution> attribution;
};

// What stands at the head of every picture of a run; empty where summary.json does not have it.
struct Caption {
  std::string title;    // the scenario's
  std::string verdict;  // "held, with flags"
  std::vector<std::string> flags;
  bool held = true;  // the force was in time, and every other budget held
};

// Reads the columns above by their names from the header line; others are ignored. Throws
// hvp::InputError with the line for a file that is missing, has no row, lacks a column or holds
// a field that is not a number.
std::vector<FrameRow> read_frames(const std::filesystem::path& path);

// Throws hvp::InputError with the key for a file that is missing, is not JSON, lacks a key or
// holds a number that is not finite or negative.
Deadline read_deadline(const std::filesystem::path& path);

// Throws InputError for a file that is missing or not JSON.
Caption read_caption(const std::filesystem::path& path);

// The contributions by size with those of one part and phase added up; what is under
// `smallest_share` of the sum, or beyond `most` rows, is one last row "other". Shares count from
// the sum of all.
std::vector<Contribution> largest_contributions(const std::vector<Contribution>& all,
                                                double smallest_share, std::size_t most);

}  // namespace hvp::draw
