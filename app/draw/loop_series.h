#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <optional>
#include <vector>

namespace hvp::draw {

// What frames.csv says of one probe in a closed loop, a value a frame; NaN where a field is empty:
// nobody holds the device, or nothing is stored.
struct ProbeSeries {
  using Components = std::array<std::vector<double>, 3>;  // x, y, z
  Components tip_m;       // where the tip was as its position was latched
  Components intended_m;  // where the hand wants it
  Components motor_N;     // the forces on the tip
  Components hand_N;
  std::vector<double> stored_J;  // in the springs of the kinematics and of the hand
  std::vector<double> port_J;    // absorbed by the loop so far; below zero it has fed energy in
};

struct LoopSeries {
  std::vector<double> time_s;  // when the frame was born
  std::vector<ProbeSeries> probes;
};

// Nothing for a run whose frames.csv has no such columns (`tip_x_m` is the first). Further probes'
// have the prefix `probe1_`, `probe2_` … Throws hvp::InputError with the line for a file that is
// missing, has no row, lacks some of a probe's columns or holds a field that is not a number.
std::optional<LoopSeries> read_loop(const std::filesystem::path& path);

// The axis (0, 1, 2: x, y, z) along which the tip or what the hand wants of it moves most.
std::size_t main_axis(const ProbeSeries& probe);

// The finite values' least and largest; {0, 0} without one.
struct Range {
  double least = 0.0;
  double largest = 0.0;
  double size() const { return largest - least; }
  void include(const Range& other);
};
Range range_of(const std::vector<double>& values);

}  // namespace hvp::draw
