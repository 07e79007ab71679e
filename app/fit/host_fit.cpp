#include <fmt/format.h>

#include "app/fit/fit_request.h"
#include "models/config/declaration.h"
#include "models/config/input_error.h"
#include "models/files/latencies.h"
#include "models/files/one_line.h"
#include "models/fit/wake_up_fit.h"
#include "models/fit/wake_up_histogram.h"

namespace hvp::app {

namespace {

// This model has no settings.
struct HostFitSettings {
  void declare(config::Visitor& /*v*/) {}
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

}  // namespace

FitOutcome fit_host(const FitRequest& request) {
  model_settings<HostFitSettings>(request.overrides);
  if (!request.options.fixed.empty()) {
    throw InputError(fmt::format("--fix {}: a distribution is fitted as a whole",
                                 files::one_line(request.options.fixed.begin()->first)));
  }
  const std::string name = request.log.filename().string();
  const fit::WakeUpHistogram histogram = fit::histogram_of(files::read_latencies_file(request.log));
  const fit::WakeUpFit fitted = fit::fit_wake_up(histogram);
  files::Log log;
  log.file = name;
  FitOutcome outcome;
  outcome.figures = figures_of("host", log, "", fitted.fit, histogram.warnings);
  outcome.figures.samples = histogram.count();
  outcome.settings = settings_of(fitted);
  outcome.plot = {"latency (us)", "share of the latencies", "", {}, {}, {}};
  const std::vector<double>& left = fitted.fit.residuals.front();
  const auto all = static_cast<double>(histogram.count() + histogram.overflows);
  for (std::size_t i = 0; i < left.size() && i < histogram.bins.size(); ++i) {
    const fit::WakeUpHistogram::Bin& bin = histogram.bins[i];
    outcome.plot.add(0.5e6 * (bin.from + bin.to), static_cast<double>(bin.count) / all, left[i]);
  }
  return outcome;
}

}  // namespace hvp::app
