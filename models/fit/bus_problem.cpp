#include "models/fit/bus_problem.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <ceres/autodiff_cost_function.h>
#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::fit {

namespace {

constexpr std::size_t kFewestTransfers = 10;
constexpr double kLongestTransfer = 10;  // s

void check_transfer_column(const std::vector<double>& values, const char* column,
                           std::size_t rows) {
  if (values.size() != rows) {
    throw InputError(fmt::format("{}: {} values beside {} sizes; expected one a transfer", column,
                                 values.size(), rows));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) continue;
    throw InputError(fmt::format("{}: row {} is no finite number", column, i + 1));
  }
}

void check(const TransferLog& log) {
  const std::size_t rows = log.bytes.size();
  check_transfer_column(log.bytes, "bytes", rows);
  check_transfer_column(log.seconds, "time", rows);
  if (!log.begun.empty()) check_transfer_column(log.begun, "begun", rows);
  if (!log.direction.empty() && log.direction.size() != rows) {
    throw InputError(fmt::format("direction: {} values beside {} sizes; expected one a transfer",
                                 log.direction.size(), rows));
  }
  for (std::size_t i = 0; i < rows; ++i) {
    if (!(log.bytes[i] > 0)) {
      throw InputError(
          fmt::format("bytes: {:g} in row {}; expected a size above zero", log.bytes[i], i + 1));
    }
    if (!(log.seconds[i] > 0) || log.seconds[i] > kLongestTransfer) {
      throw InputError(
          fmt::format("time: {:g} s in row {}; expected above zero and at most {:g} s, "
                      "is it in us?",
                      log.seconds[i], i + 1, kLongestTransfer));
    }
  }
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::shared_ptr<const BusProblem::Group> group(const TransferLog& log,
                                               const std::vector<std::size_t>& rows,
                                               std::string prefix) {
  auto result = std::make_shared<BusProblem::Group>();
  result->prefix = std::move(prefix);
  for (const std::size_t i : rows) {
    result->bytes.push_back(log.bytes[i]);
    result->seconds.push_back(log.seconds[i]);
  }
  const std::string of =
      result->prefix.empty()
          ? std::string()
          : " of direction " + result->prefix.substr(0, result->prefix.size() - 1);
  if (rows.size() < kFewestTransfers) {
    throw InputError(fmt::format("bytes: {} transfers{}; expected at least {}", rows.size(), of,
                                 kFewestTransfers));
  }
  const auto times = std::minmax_element(result->seconds.begin(), result->seconds.end());
  if (*times.first == *times.second) {
    throw InputError(fmt::format(
        "time: all {:g} s{}; expected times that differ, from a finer clock", *times.first, of));
  }
  return result;
}

// Rows of a direction in the order in which they began.
std::vector<std::size_t> rows_of(const TransferLog& log, const link::Direction* direction) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < log.bytes.size(); ++i) {
    if (direction == nullptr || log.direction[i] == *direction) rows.push_back(i);
  }
  if (log.begun.empty()) return rows;
  std::stable_sort(rows.begin(), rows.end(),
                   [&](std::size_t a, std::size_t b) { return log.begun[a] < log.begun[b]; });
  return rows;
}

// A line through the medians of the smaller and of the larger half, which few outliers do not move.
struct Line {
  double latency;    // s
  double bandwidth;  // bytes/s
};
Line line_through_medians(const BusProblem::Group& g) {
  const double middle = median(g.bytes);
  std::array<std::vector<double>, 2> bytes;
  std::array<std::vector<double>, 2> seconds;
  for (std::size_t i = 0; i < g.bytes.size(); ++i) {
    const std::size_t half = g.bytes[i] >= middle ? 1 : 0;
    bytes[half].push_back(g.bytes[i]);
    seconds[half].push_back(g.seconds[i]);
  }
  const double large = median(bytes[1]);
  const double long_time = median(seconds[1]);
  if (!bytes[0].empty()) {
    const double small = median(bytes[0]);
    const double short_time = median(seconds[0]);
    if (long_time > short_time) {
      const double bandwidth = (large - small) / (long_time - short_time);
      return {std::max(0.0, short_time - small / bandwidth), bandwidth};
    }
  }
  return {0.5 * long_time, 2 * large / long_time};
}

void add_parameters(const BusProblem::Group& g, std::vector<Parameter>& parameters) {
  constexpr double kSlowest = 1e2;   // bytes/s
  constexpr double kFastest = 1e13;  // bytes/s
  const Line line = line_through_medians(g);
  const double longest = *std::max_element(g.seconds.begin(), g.seconds.end());
  const double typical = median(g.seconds);
  const double bandwidth = std::clamp(line.bandwidth, kSlowest, kFastest);
  parameters.push_back({.name = g.prefix + "latency",
                        .unit = "s",
                        .start = line.latency,
                        .low = 0,
                        .high = longest,
                        .because = "nothing ends before it begins, or later than the longest did",
                        .logarithmic = false,
                        .draw_low = 0,
                        .draw_high = typical,
                        .matters = 0.05 * typical,
                        .remedy = "transfers of several sizes, small ones among them"});
  parameters.push_back({.name = g.prefix + "bandwidth",
                        .unit = "bytes/s",
                        .start = bandwidth,
                        .low = kSlowest,
                        .high = kFastest,
                        .because = "between a serial line's and more than any memory's",
                        .logarithmic = true,
                        .draw_low = std::max(kSlowest, 0.1 * bandwidth),
                        .draw_high = std::min(kFastest, 10 * bandwidth),
                        .matters = 0,
                        .remedy = "transfers of several sizes"});
}

struct TimeResidual {
  std::shared_ptr<const BusProblem::Group> group;
  std::size_t first = 0;  // parameter

  template <class T>
  bool operator()(const T* values, T* residuals) const {
    const T& latency = values[first];
    const T& bandwidth = values[first + 1];
    for (std::size_t i = 0; i < group->seconds.size(); ++i) {
      residuals[i] = group->seconds[i] - latency - group->bytes[i] / bandwidth;
    }
    return true;
  }
};

template <int Parameters>
std::unique_ptr<ceres::CostFunction> cost_of(std::shared_ptr<const BusProblem::Group> group,
                                             std::size_t first) {
  const auto rows = static_cast<int>(group->seconds.size());
  return std::make_unique<ceres::AutoDiffCostFunction<TimeResidual, ceres::DYNAMIC, Parameters>>(
      new TimeResidual{std::move(group), first}, rows);
}

}  // namespace

BusProblem::BusProblem(const TransferLog& log) {
  check(log);
  const auto reads = static_cast<std::size_t>(
      std::count(log.direction.begin(), log.direction.end(), link::Direction::read));
  if (log.direction.empty()) groups_.push_back(group(log, rows_of(log, nullptr), ""));
  for (const link::Direction d : {link::Direction::read, link::Direction::write}) {
    const bool read = d == link::Direction::read;
    if ((read ? reads : log.direction.size() - reads) == 0) continue;
    groups_.push_back(group(log, rows_of(log, &d), read ? "read_" : "write_"));
  }
  for (const auto& g : groups_) {
    add_parameters(*g, parameters_);
    if (log.begun.empty() && std::is_sorted(g->bytes.begin(), g->bytes.end()) &&
        g->bytes.front() < g->bytes.back()) {
      warnings_.push_back(fmt::format(
          "bytes: the transfers{} are sorted by size and have no time of their own: what is held "
          "out are the largest, and drift cannot be told from size",
          g->prefix.empty() ? "" : " of " + g->prefix.substr(0, g->prefix.size() - 1)));
    }
  }
}

double BusProblem::signal_rms() const {
  double squares = 0;
  std::size_t count = 0;
  for (const auto& g : groups_) {
    const double mean = std::accumulate(g->seconds.begin(), g->seconds.end(), 0.0) /
                        static_cast<double>(g->seconds.size());
    for (const double t : g->seconds) squares += (t - mean) * (t - mean);
    count += g->seconds.size();
  }
  return std::sqrt(squares / static_cast<double>(count));
}

Problem::Stretch BusProblem::stretch(std::size_t index) const {
  return {.residuals = groups_[index]->seconds.size(), .own = {}};
}

std::unique_ptr<ceres::CostFunction> BusProblem::cost(std::size_t stretch) const {
  if (groups_.size() == 1) return cost_of<2>(groups_[0], 0);
  return cost_of<4>(groups_[stretch], 2 * stretch);
}

namespace {

// The ranges are those that link::Pci declares.
constexpr int kLongestBurst = 4096;
constexpr int kMostOverhead = 64;
constexpr int kLeastOverhead = 2;
constexpr int kMostWaits = 16;
constexpr double kLongestBusLatency = 1e-3;  // s

constexpr double kAsGood = 0.005;   // of the bandwidth
constexpr double kNotEqual = 0.05;  // likewise: to be told

// The bandwidth of whole bursts with so many clocks that carry no data.
double bandwidth(const link::Pci& pci, int overhead) {
  const double clocks = overhead + static_cast<double>(pci.burst_bytes) / pci.width_bytes();
  return pci.burst_bytes / (clocks * static_cast<double>(pci.clock_period_ps()) * 1e-12);
}

double deviation(const link::Pci& pci, const std::optional<Link>& read,
                 const std::optional<Link>& write) {
  double worst = 0;
  if (read) worst = std::abs(std::log(read_bandwidth(pci) / read->bandwidth));
  if (write) worst = std::max(worst, std::abs(std::log(write_bandwidth(pci) / write->bandwidth)));
  return worst;
}

// Keys that differ, and, below one, by how much.
double change(const link::Pci& a, const link::Pci& base) {
  double keys = a.kind == base.kind ? 0 : 1;
  double size = 0;
  if (a.burst_bytes != base.burst_bytes) {
    ++keys;
    size += std::abs(std::log2(static_cast<double>(a.burst_bytes) / base.burst_bytes)) / 10;
  }
  if (a.overhead_clocks != base.overhead_clocks) {
    ++keys;
    size += std::abs(a.overhead_clocks - base.overhead_clocks) / static_cast<double>(kMostOverhead);
  }
  if (a.read_wait_clocks != base.read_wait_clocks) {
    ++keys;
    size += std::abs(a.read_wait_clocks - base.read_wait_clocks) / static_cast<double>(kMostWaits);
  }
  return keys + size / 4;
}

std::vector<link::Pci> all(const link::Pci& base, bool reads) {
  std::vector<link::Pci> settings;
  for (const link::PciKind kind : {link::PciKind::pci_32_33, link::PciKind::pci_32_66,
                                   link::PciKind::pci_64_66, link::PciKind::pci_x_133}) {
    link::Pci pci = base;
    pci.kind = kind;
    for (pci.burst_bytes = pci.width_bytes(); pci.burst_bytes <= kLongestBurst;
         pci.burst_bytes *= 2) {
      for (pci.overhead_clocks = kLeastOverhead; pci.overhead_clocks <= kMostOverhead;
           ++pci.overhead_clocks) {
        if (!reads) {
          settings.push_back(pci);
          continue;
        }
        for (pci.read_wait_clocks = 0; pci.read_wait_clocks <= kMostWaits; ++pci.read_wait_clocks) {
          settings.push_back(pci);
        }
        pci.read_wait_clocks = base.read_wait_clocks;
      }
    }
  }
  return settings;
}

void set_latency(const char* name, const Link& measured, double& latency,
                 std::vector<std::string>& warnings) {
  latency = std::clamp(measured.latency_s, 0.0, kLongestBusLatency);
  if (latency == measured.latency_s) return;
  warnings.push_back(fmt::format("{}_latency: {:g} us measured, {:g} us is the most that [bus] has",
                                 name, measured.latency_s * 1e6, latency * 1e6));
}

void tell(const char* name, double measured, double modelled, std::vector<std::string>& warnings) {
  if (std::abs(modelled / measured - 1) <= kNotEqual) return;
  warnings.push_back(fmt::format(
      "{} bandwidth: {:.4g} MB/s measured, {:.4g} MB/s is the nearest that conventional PCI has",
      name, measured * 1e-6, modelled * 1e-6));
}

}  // namespace

double read_bandwidth(const link::Pci& pci) {
  return bandwidth(pci, pci.overhead_clocks + pci.read_wait_clocks);
}

double write_bandwidth(const link::Pci& pci) { return bandwidth(pci, pci.overhead_clocks); }

NearestPci nearest_pci(const link::Pci& base, const std::optional<Link>& read,
                       const std::optional<Link>& write) {
  NearestPci nearest{.pci = base, .read_deviation = {}, .write_deviation = {}, .warnings = {}};
  if (!read && !write) return nearest;
  std::vector<link::Pci> settings = all(base, read.has_value());
  settings.push_back(base);  // its burst may be no power of two
  double best = std::numeric_limits<double>::infinity();
  for (const link::Pci& pci : settings) best = std::min(best, deviation(pci, read, write));
  double least = std::numeric_limits<double>::infinity();
  for (const link::Pci& pci : settings) {
    const double changed = change(pci, base);
    if (changed >= least || deviation(pci, read, write) > best + kAsGood) continue;
    least = changed;
    nearest.pci = pci;
  }
  if (read) {
    set_latency("read", *read, nearest.pci.read_latency_s, nearest.warnings);
    nearest.read_deviation = read_bandwidth(nearest.pci) / read->bandwidth - 1;
    tell("read", read->bandwidth, read_bandwidth(nearest.pci), nearest.warnings);
  }
  if (write) {
    set_latency("write", *write, nearest.pci.write_latency_s, nearest.warnings);
    nearest.write_deviation = write_bandwidth(nearest.pci) / write->bandwidth - 1;
    tell("write", write->bandwidth, write_bandwidth(nearest.pci), nearest.warnings);
  }
  return nearest;
}

}  // namespace hvp::fit
