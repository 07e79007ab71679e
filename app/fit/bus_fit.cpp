#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "app/fit/fit_request.h"
#include "models/config/declaration.h"
#include "models/config/input_error.h"
#include "models/fit/bus_problem.h"
#include "models/fit/nearest_pcie.h"

namespace hvp::app {

namespace {

enum class LinkKind { pci, pcie };

struct BusFitSettings {
  LinkKind link = LinkKind::pci;
  link::Direction direction = link::Direction::read;

  void declare(config::Visitor& v) {
    v.choice("link", link, {{"pci", LinkKind::pci}, {"pcie", LinkKind::pcie}},
             {"pci: the nearest settings of [bus]; pcie: of [bus.pcie], whose board reads and "
              "writes the host's memory, as transfer.method = \"dma\" does",
              "the thesis' bus"});
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
        "no kind of [bus] is as fast: nothing is written for it; --set link=pcie seeks "
        "one of [bus.pcie]");
    return settings;
  }
  const link::Pci& pci = nearest.pci;
  const auto add = [&](const char* key, std::string value, std::string parameter) {
    const bool derived = !std::string_view(key).ends_with("latency");
    settings.push_back({"bus", key, std::move(value), std::move(parameter), derived});
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

// The direction's transfers in the log: medians of each size, moved by what the fit's line differs
// from the log's own where the fit is of several logs.
fit::TimesOfSizes times_of(const fit::TransferLog& log, bool told, link::Direction wanted,
                           const std::optional<fit::Link>& own,
                           const std::optional<fit::Link>& of) {
  std::vector<double> bytes;
  std::vector<double> seconds;
  for (std::size_t i = 0; i < log.bytes.size(); ++i) {
    if (told && log.direction[i] != wanted) continue;
    bytes.push_back(log.bytes[i]);
    seconds.push_back(log.seconds[i]);
  }
  fit::TimesOfSizes times = fit::medians_of_sizes(bytes, seconds);
  if (times.empty() && of) {
    // Another log has this direction: the line says what it takes.
    for (const double size : {64.0, 1024.0, 16384.0, 262144.0}) {
      times.bytes.push_back(size);
      times.seconds.push_back(of->latency_s + size / of->bandwidth);
    }
  }
  if (!own || !of) return times;
  for (std::size_t i = 0; i < times.bytes.size(); ++i) {
    const double moved =
        of->latency_s - own->latency_s + times.bytes[i] * (1 / of->bandwidth - 1 / own->bandwidth);
    times.seconds[i] = std::max(times.seconds[i] + moved, 1e-12);
  }
  return times;
}

// The settings of PCI Express with which the platform's link has the log's times.
std::vector<FittedSetting> pcie_settings(const fit::Fit& fit, const fit::Fit& own,
                                         const fit::TransferLog& log, bool told,
                                         link::Direction direction,
                                         std::vector<std::string>& notes) {
  const auto of = [&](link::Direction wanted) {
    if (!told && wanted != direction) return fit::TimesOfSizes{};
    const std::string prefix = !told ? "" : wanted == link::Direction::read ? "read_" : "write_";
    return times_of(log, told, wanted, link_of(own, prefix), link_of(fit, prefix));
  };
  const fit::TimesOfSizes read = of(link::Direction::read);
  const fit::TimesOfSizes write = of(link::Direction::write);
  if (std::max(read.bytes.size(), write.bytes.size()) < 2) {
    throw InputError(
        "the transfers are all of one size: expected several, of which a link's rate "
        "and latency show");
  }
  const fit::NearestPcie nearest = fit::nearest_pcie({}, read, write);
  for (const std::string& w : nearest.warnings) notes.push_back(w);
  const auto tell = [&](const char* what, const std::optional<double>& by) {
    if (!by) return;
    notes.push_back(fmt::format(
        "half of the sizes' {}s are within {:.2g} % of the nearest settings'", what, 100 * *by));
  };
  tell("read", nearest.read_deviation);
  tell("write", nearest.write_deviation);
  std::vector<FittedSetting> settings;
  const auto add = [&](const char* key, std::string value, std::string parameter) {
    settings.push_back({"bus.pcie", key, std::move(value), std::move(parameter), true});
  };
  const bool reads = !read.empty();
  const std::string prefix = !told ? "" : reads ? "read_" : "write_";
  const link::Pcie& pcie = nearest.pcie;
  add("generation", fmt::format("\"gen{}\"", 1 + static_cast<int>(pcie.generation)),
      prefix + "bandwidth");
  add("lanes", fmt::format("{}", pcie.lanes), prefix + "bandwidth");
  add("max_payload_bytes", fmt::format("{}", pcie.max_payload_bytes), prefix + "bandwidth");
  if (reads) {
    add("outstanding_reads", fmt::format("{}", pcie.outstanding_reads), prefix + "bandwidth");
    add("root_complex_latency", toml_quantity(pcie.root_complex_latency_s, "s"),
        prefix + "latency");
  }
  if (!write.empty()) {
    add("link_latency", toml_quantity(pcie.link_latency_s, "s"),
        told ? "write_latency" : "latency");
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
  const bool told = write != nullptr;
  const link::Direction direction = settings.direction;
  const fit::Fit own = outcome.figures.fit;
  const auto chosen = [=, link = settings.link](const fit::Fit& of,
                                                std::vector<std::string>& notes) {
    return link == LinkKind::pcie ? pcie_settings(of, own, transfers, told, direction, notes)
                                  : settings_of(of, told, direction, notes);
  };
  outcome.settings = chosen(own, outcome.figures.warnings);
  outcome.settings_of = [chosen](const fit::Fit& of) {
    std::vector<std::string> notes;  // each log has its own
    return chosen(of, notes);
  };
  outcome.plot = plot_of(outcome.figures.fit, transfers, told);
  return outcome;
}

}  // namespace hvp::app
