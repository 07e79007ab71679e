#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "models/fit/problem.h"
#include "models/link/direction.h"

namespace hvp::fit {

// Transfers over a bus and how long each took, one row each.
struct TransferLog {
  std::vector<double> bytes;
  std::vector<double> seconds;
  std::vector<double> begun = {};               // s, when it began; empty: not known
  std::vector<link::Direction> direction = {};  // empty: not known, all alike
};

// A straight line through the times, latency + bytes/bandwidth, for each direction by itself. The
// parameters are latency (s) and bandwidth (bytes/s), or, where the log has both directions,
// read_latency, read_bandwidth, write_latency and write_bandwidth.
//
// What disturbs a transfer makes it longer (interrupts, other masters): fit it with Loss::cauchy.
// Rows are no even steps in time. They are taken in the order in which they began, or, where that
// is not known, as they stand; noise that is alike from one transfer to the next widens the
// intervals then as it would in time, row taking the place of second.
class BusProblem : public Problem {
 public:
  // Throws InputError: fewer than ten transfers of a direction, columns of different lengths,
  // sizes or times that are not finite and above zero, times that are all alike, or above 10 s.
  explicit BusProblem(const TransferLog& log);

  const std::vector<Parameter>& parameters() const override { return parameters_; }
  std::string unit() const override { return "s"; }
  double signal_rms() const override;
  std::size_t stretches() const override { return groups_.size(); }
  Stretch stretch(std::size_t index) const override;
  std::unique_ptr<ceres::CostFunction> cost(std::size_t stretch) const override;

  const std::vector<std::string>& warnings() const { return warnings_; }

  // Of one direction, in order.
  struct Group {
    std::string prefix;  // of its parameters: "read_" or nothing
    std::vector<double> bytes;
    std::vector<double> seconds;
  };

 private:
  std::vector<std::shared_ptr<const Group>> groups_;
  std::vector<Parameter> parameters_;
  std::vector<std::string> warnings_;
};

}  // namespace hvp::fit
