#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "models/fit/problem.h"
#include "models/link/direction.h"
#include "models/link/pci.h"

namespace hvp::fit {

// Transfers over a bus and how long each took, one row each.
struct TransferLog {
  std::vector<double> bytes;
  std::vector<double> seconds;
  std::vector<double> begun = {};  // s, the time at which it began; empty: not known
  std::vector<link::Direction> direction =
      {};  // empty: not known, and taken to be the same for all
};

// A straight line through the times of transfers, latency + bytes/bandwidth, for each direction by
// itself. The parameters are latency (s) and bandwidth (bytes/s) or, where the log tells
// directions, those of them that it has: read_latency, read_bandwidth, write_latency and
// write_bandwidth.
//
// Disturbances (interrupts, other masters) only lengthen a transfer: fit this problem with
// Loss::cauchy. The rows are not evenly spaced in time. They are taken in the order in which they
// began or, where that is not known, in the order of the log. Noise that is alike from one transfer
// to the next then widens the intervals as it would in time, with rows in the place of seconds.
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

  // The transfers of one direction, in order.
  struct Group {
    std::string prefix;  // prefix of its parameters' names: "read_" or nothing
    std::vector<double> bytes;
    std::vector<double> seconds;
  };

 private:
  std::vector<std::shared_ptr<const Group>> groups_;
  std::vector<Parameter> parameters_;
  std::vector<std::string> warnings_;
};

// The fitted latency and bandwidth of one direction.
struct Link {
  double latency_s = 0;
  double bandwidth = 0;  // bytes/s
};

// The settings of [bus] that come nearest to a measurement.
struct NearestPci {
  link::Pci pci;
  // The setting's bandwidth divided by the measured one, minus one.
  std::optional<double> read_deviation;
  std::optional<double> write_deviation;
  std::vector<std::string> warnings;
};

// The bandwidth of transfers of whole bursts, bytes/s, without the latency.
double read_bandwidth(const link::Pci& pci);
double write_bandwidth(const link::Pci& pci);

// Finds the PCI settings that come nearest to the measured latencies and bandwidths. The latencies
// are the measured ones, because a straight line through transfers of whole bursts meets the axis
// there. The bandwidth has steps: kind, length of bursts, clocks of overhead and of waiting are
// tried in all combinations. Of those within half a percent of the best, the one is taken that
// changes the fewest of `base`'s keys, and these by the least. What was not measured stays as in
// `base`.
NearestPci nearest_pci(const link::Pci& base, const std::optional<Link>& read,
                       const std::optional<Link>& write);

}  // namespace hvp::fit
