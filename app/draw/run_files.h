#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

// The result files of a run that pictures are drawn from: frames.csv and summary.json.

namespace hvp::draw {

// Opens a file for reading. Throws InputError for a file that is missing or not a regular one.
std::ifstream open_file(const std::filesystem::path& path);

// A row of frames.csv. Times in microseconds, as in the file.
struct FrameRow {
  long frame = 0;
  double latency_us = 0.0;  // NaN for a skipped tick, whose field is empty
  bool in_time = true;
  int contact_node = -1;
};

struct Contribution {
  std::string part;
  std::string phase;
  double us = 0.0;
};

// The figures on the deadline in summary.json.
struct Deadline {
  double period_us = 0.0;
  double worst_us = 0.0;
  double budget_us = 0.0;  // the period where the file states none
  std::vector<Contribution> attribution;
};

// The caption of every picture of a run; empty where summary.json does not have it.
struct Caption {
  std::string title;    // the scenario's
  std::string verdict;  // "held, with flags"
  std::vector<std::string> flags;
  bool held = true;  // the force was in time, and every other budget was met
};

// Reads the columns of FrameRow by their names from the header line and ignores others. Throws
// hvp::InputError with the line for a file that is missing, has no row, lacks a column or has
// a field that is not a number.
std::vector<FrameRow> read_frames(const std::filesystem::path& path);

// Throws hvp::InputError with the key for a file that is missing, is not JSON, lacks a key or
// has a number that is not finite or negative.
Deadline read_deadline(const std::filesystem::path& path);

// Throws InputError for a file that is missing or not JSON.
Caption read_caption(const std::filesystem::path& path);

// The contributions in descending order, with those of one part and phase added up. Contributions
// below `smallest_share` of the sum of all, or beyond `most` rows, are one last row "other".
std::vector<Contribution> largest_contributions(const std::vector<Contribution>& all,
                                                double smallest_share, std::size_t most);

// The columns of frames.csv for one probe in a closed loop, a value a frame. NaN is an empty field:
// no hand grips the device, or no energy is stored.
struct ProbeSeries {
  using Components = std::array<std::vector<double>, 3>;  // x, y, z
  Components tip_m;                                       // the tip's position when it was latched
  Components intended_m;                                  // the position that the hand intends
  Components motor_N;                                     // the forces on the tip
  Components hand_N;
  std::vector<double> stored_J;  // in the springs of the kinematics and of the hand
  std::vector<double> port_J;    // absorbed by the loop so far
  std::vector<double> fed_in;    // 1 where the loop has fed energy in
};

struct LoopSeries {
  std::vector<double> time_s;  // the frames' ticks
  std::vector<ProbeSeries> probes;
};

// Reads the columns of a closed loop; absent for a run whose frames.csv does not have them
// (`tip_x_m` is the first). Columns of further probes have the prefix `probe1_`, `probe2_` … Throws
// hvp::InputError with the line for a file that is missing, has no row, lacks some of a probe's
// columns or has a field that is not a number.
std::optional<LoopSeries> read_loop(const std::filesystem::path& path);

// The axis (0, 1, 2: x, y, z) along which the tip or its intended position moves most.
std::size_t main_axis(const ProbeSeries& probe);

// An interval of values.
struct Range {
  double least = 0.0;
  double largest = 0.0;
  double size() const { return largest - least; }
  void include(const Range& other);
};
// The least and the largest finite value; {0, 0} without one.
Range range_of(const std::vector<double>& values);

}  // namespace hvp::draw
