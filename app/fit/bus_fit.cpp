#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "app/fit/fit_request.h"
#include "models/config/declaration.h"
#include "models/fit/bus_problem.h"

namespace hvp::app {

namespace {

struct BusFitSettings {
  link::Direction direction = link::Direction::read;

  void declare(config::Visitor& v) {
    v.choice("direction", direction,
             {{"read", link::Direction::read}, {"write", link::Direction::write}},
             {"of transfers in a log that does not say it by a column write_count"});
  }
};

std::optional<fit::Link> link_of(const fit::Fit& fit, const std::string& prefix) {
  std::optional<fit::Link> link;
  for (const fit::Estimate& e : fit.parameters) {
    if (e.name == prefix + "latency") link.emplace().latency_s = e.value;
  }
  if (link) link->bandwidth = estimate(fit, prefix + "bandwidth").value;
  return link;
}

// The settings with which the platform's bus has the fitted figures, and notes of how nearly.
std::vector<FittedSetting> settings_of(const fit::Fit& fit, bool told, link::Direction direction,
                                       std::vector<std::string>& notes) {
  std::vector<FittedSetting> settings;
  const bool read = direction == link::Direction::read;
  const std::string prefix_of_read = told ? "read_" : "";
  const std::string prefix_of_write = told ? "write_" : "";
  const auto of_read = told || read ? link_of(fit, prefix_of_read) : std::nullopt;
  const auto of_write = told || !read ? link_of(fit, prefix_of_write) : std::nullopt;
  const fit::NearestPci nearest = fit::nearest_pci({}, of_read, of_write);
  for (const std::string& w : nearest.warnings) notes.push_back(w);
  const auto deviation = [&](const char* of, const std::optional<double>& by) {
    if (!by) return;
    notes.push_back(fmt::format(
        "the nearest settings of [bus] {} {:+.1f} % of the measured bandwidth", of, 100 * *by));
  };
  deviation("read at", nearest.read_deviation);
  deviation("write at", nearest.write_deviation);
  // A link that is far faster than any kind of the bus is no such bus: its settings would be those
  // of another one.
  constexpr double kFarFaster = -0.2;
  if (std::min(nearest.read_deviation.value_or(0), nearest.write_deviation.value_or(0)) <
      kFarFaster) {
    notes.emplace_back(
        "no kind of [bus] is as fast: nothing is written for it; describe the link by [bus.pcie]");
    return settings;
  }
  const link::Pci& pci = nearest.pci;
  const auto add = [&](const char* key, std::string value, std::string parameter) {
    settings.push_back({"bus", key, std::move(value), std::move(parameter)});
  };
  const std::string of_bandwidth = (of_read ? prefix_of_read : prefix_of_write) + "bandwidth";
  const char* const kinds[] = {"pci-32/33", "pci-32/66", "pci-64/66", "pci-x-133"};
  add("kind", fmt::format("\"{}\"", kinds[static_cast<std::size_t>(pci.kind)]), of_bandwidth);
  add("burst_bytes", fmt::format("{}", pci.burst_bytes), of_bandwidth);
  add("overhead_clocks", fmt::format("{}", pci.overhead_clocks), of_bandwidth);
  add("read_wait_clocks", fmt::format("{}", pci.read_wait_clocks), of_bandwidth);
  if (of_read) {
    add("read_latency", toml_quantity(pci.read_latency_s, "s"), prefix_of_read + "latency");
  }
  if (of_write) {
    add("write_latency", toml_quantity(pci.write_latency_s, "s"), prefix_of_write + "latency");
  }
  return settings;
}

// The plot of times over sizes, one direction after the other.
FitPlot plot_of(const fit::Fit& fit, const fit::TransferLog& log, bool told) {
  FitPlot plot{"size (bytes)", "time of a transfer", "s", {}, {}, {}};
  std::vector<std::size_t> order(log.bytes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return log.bytes[a] < log.bytes[b]; });
  for (const std::size_t i : order) {
    const bool write = told && log.direction[i] == link::Direction::write;
    const std::string prefix = !told ? "" : write ? "write_" : "read_";
    const double modelled = estimate(fit, prefix + "latency").value +
                            log.bytes[i] / estimate(fit, prefix + "bandwidth").value;
    plot.add(log.bytes[i], log.seconds[i], log.seconds[i] - modelled);
  }
  return plot;
}

}  // namespace

FitOutcome fit_bus(const FitRequest& request) {
  const auto settings = model_settings<BusFitSettings>(request.overrides);
  FitRequest asked = request;
  asked.reading.over_time = false;
  const files::Log log = asked.read({"size", "time", "write", "began"});
  fit::TransferLog transfers{log.column("size", "B").values, log.column("time", "s").values};
  const files::LogColumn* write = log.find("write");
  if (write != nullptr) {
    for (const double w : write->values) {
      transfers.direction.push_back(w != 0 ? link::Direction::write : link::Direction::read);
    }
  }
  if (log.find("began") != nullptr) transfers.begun = log.column("began", "s").values;
  const fit::BusProblem problem(transfers);
  if (asked.options.loss == fit::Loss::squares) asked.options.loss = fit::Loss::cauchy;

  FitOutcome outcome;
  outcome.figures =
      figures_of("bus", log, problem.unit(), fit::fit(problem, asked.options), problem.warnings());
  const bool told = write != nullptr && outcome.figures.fit.parameters.size() > 2;
  const link::Direction direction = settings.direction;
  outcome.settings = settings_of(outcome.figures.fit, told, direction, outcome.figures.warnings);
  outcome.settings_of = [told, direction](const fit::Fit& of) {
    std::vector<std::string> notes;  // each log has its own
    return settings_of(of, told, direction, notes);
  };
  outcome.plot = plot_of(outcome.figures.fit, transfers, told);
  return outcome;
}

}  // namespace hvp::app
