#include <cmath>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "app/fit/fit_request.h"
#include "app/scenario/toml_text.h"
#include "models/config/declaration.h"
#include "models/config/input_error.h"
#include "models/files/latencies.h"
#include "models/files/one_line.h"
#include "models/fit/tail_fit.h"
#include "models/fit/wake_up_fit.h"
#include "models/fit/wake_up_histogram.h"

namespace hvp::app {

namespace {

enum class Form { parametric, measured };

struct HostFitSettings {
  Form form = Form::parametric;
  double tail_share = 0;  // 0: chosen

  void declare(config::Visitor& v) {
    v.variant("distribution", form,
              {{"parametric", Form::parametric}, {"measured", Form::measured}},
              {"parametric: the best of exponential, normal and lognormal; measured: the latencies "
               "themselves, with a generalised Pareto distribution for the longest",
               "a distribution in three numbers is the easiest to vary"})
        .only({Form::measured}, [&] {
          v.quantity("tail_share", tail_share, config::Dimension::dimensionless,
                     config::between(0, 0.5),
                     {"of the latencies that are fitted as the tail; 0: the largest share that a "
                      "generalised Pareto distribution fits",
                      "chosen by the fit's own test"});
        });
  }
};

std::vector<FittedSetting> settings_of(const fit::WakeUpFit& fitted) {
  std::vector<FittedSetting> settings = {
      {"host.wake_up", "distribution",
       fmt::format("\"{}\"", random::name(fitted.distribution.kind)), ""}};
  for (const fit::Estimate& e : fitted.fit.parameters) {
    settings.push_back(
        {"host.wake_up", e.name,
         e.unit.empty() ? fmt::format("{}", e.value) : toml_quantity(e.value, e.unit), e.name});
  }
  return settings;
}

// The bins of the fitted residuals, which are those with a count, as shares of all.
void plot_bins(const fit::WakeUpHistogram& histogram, const std::vector<double>& left,
               FitPlot& plot) {
  const auto all = static_cast<double>(histogram.count() + histogram.overflows);
  std::size_t next = 0;
  for (const fit::WakeUpHistogram::Bin& bin : histogram.bins) {
    if (bin.count == 0 || next == left.size()) continue;
    plot.add(0.5e6 * (bin.from + bin.to), static_cast<double>(bin.count) / all, left[next++]);
  }
}

// The share of the latencies that are longer than a bin's end, from the threshold on, where there
// are any: a tail is read off over its powers of ten.
void plot_tail(const fit::WakeUpHistogram& histogram, const fit::WakeUpTail& tail, FitPlot& plot) {
  random::TimeDistribution d;
  d.tail_from_s = tail.from_s;
  d.tail_scale_s = estimate(tail.fit, "tail_scale").value;
  d.tail_shape = estimate(tail.fit, "tail_shape").value;
  std::int64_t left = tail.count;
  for (const fit::WakeUpHistogram::Bin& bin : histogram.bins) {
    if (bin.count == 0 || bin.from < tail.from_s) continue;
    left -= bin.count;
    const double modelled = d.tail_above(bin.to);
    if (left == 0 || modelled <= 0) continue;
    const double seen = static_cast<double>(left) / static_cast<double>(tail.count);
    plot.add(1e6 * bin.to, std::log10(tail.share * seen), std::log10(seen / modelled));
  }
}

// The log as the folder of the table names it, which is where a scenario looks for it.
std::string named_from(const std::filesystem::path& folder, const std::filesystem::path& log) {
  std::error_code error;
  const auto relative = std::filesystem::relative(log, folder.empty() ? "." : folder, error);
  return (error || relative.empty() ? log : relative).generic_string();
}

fit::Estimate given(const char* name, const char* unit, double value) {
  return {.name = name, .unit = unit, .value = value, .low = value, .high = value, .fixed = true};
}

FitOutcome fit_measured(const FitRequest& request, const fit::WakeUpHistogram& histogram,
                        double share) {
  fit::WakeUpTail tail = fit_tail(histogram, share > 0 ? std::optional(share) : std::nullopt);
  std::vector<fit::Estimate>& parameters = tail.fit.parameters;
  parameters.insert(parameters.begin(),
                    {given("tail_share", "", tail.share), given("tail_from", "s", tail.from_s)});
  FitOutcome outcome;
  outcome.plot = {"latency (us)", "log10 of the share that is longer", "", {}, {}, {}};
  plot_tail(histogram, tail, outcome.plot);
  const std::string file = named_from(request.out_folder, request.log);
  constexpr const char* kTable = "host.wake_up";
  outcome.settings = {{kTable, "distribution", "\"measured\"", ""},
                      {kTable, "samples", scenario::toml_string(file), ""},
                      {kTable, "tail", "\"pareto\"", ""}};
  for (const fit::Estimate& e : parameters) {
    if (e.name == "tail_share" || e.name.starts_with("exceeded")) continue;
    outcome.settings.push_back(
        {kTable, e.name,
         e.unit.empty() ? fmt::format("{}", e.value) : toml_quantity(e.value, e.unit), e.name});
  }
  files::Log log;
  log.file = request.log.filename().string();
  outcome.figures = figures_of("host", log, "", tail.fit, histogram.warnings);
  outcome.figures.samples = histogram.count() + histogram.overflows;
  return outcome;
}

}  // namespace

FitOutcome fit_host(const FitRequest& request) {
  const auto settings = model_settings<HostFitSettings>(request.overrides);
  if (!request.options.fixed.empty()) {
    throw InputError(fmt::format("--fix {}: a distribution is fitted as a whole",
                                 files::one_line(request.options.fixed.begin()->first)));
  }
  const std::string name = request.log.filename().string();
  const fit::WakeUpHistogram histogram = fit::histogram_of(files::read_latencies_file(request.log));
  if (settings.form == Form::measured) {
    return fit_measured(request, histogram, settings.tail_share);
  }
  const fit::WakeUpFit fitted = fit::fit_wake_up(histogram);
  files::Log log;
  log.file = name;
  FitOutcome outcome;
  outcome.figures = figures_of("host", log, "", fitted.fit, histogram.warnings);
  outcome.figures.samples = histogram.count();
  outcome.settings = settings_of(fitted);
  outcome.plot = {"latency (us)", "share of the latencies", "", {}, {}, {}};
  plot_bins(histogram, fitted.fit.residuals.front(), outcome.plot);
  return outcome;
}

}  // namespace hvp::app
