#include "app/fit/fit_request.h"
#include "app/fit/model_settings.h"
#include "models/config/declaration.h"
#include "models/fit/qlv_problem.h"

namespace hvp::app {

namespace {

struct QlvFitSettings : fit::QlvSettings {
  void declare(config::Visitor& v) {
    v.choice("elastic", elastic, {{"fung", fit::Elastic::fung}, {"power", fit::Elastic::power}},
             {"the elastic force over depth: Fung's exponential, or a power law"});
    v.integer("exponentials", exponentials, {1, 3}, {"of the reduced relaxation"});
  }
};

const files::LogColumn& travel_of(const files::Log& log) {
  for (const char* name : {"travel", "displacement", "depth", "position"}) {
    if (const files::LogColumn* column = log.find(name)) return log.column(column->quantity, "m");
  }
  return log.column("travel", "m");
}

}  // namespace

FitOutcome fit_qlv(const FitRequest& request) {
  const auto settings = model_settings<QlvFitSettings>(request.overrides);
  const files::Log log = request.read({"force", "travel", "displacement", "depth", "position"});
  const fit::QlvProblem problem(settings,
                                {log.time, travel_of(log).values, log.column("force", "N").values});
  FitOutcome outcome;
  outcome.figures = figures_of("qlv", log, problem.unit(), fit::fit(problem, request.options),
                               problem.warnings());
  outcome.figures.warnings.emplace_back(
      "the platform's body is elastic: no key of a scenario stands for these values");
  outcome.plot = {"time (s)", "force", "N", {}, {}, {}};
  const fit::PressedLog& pressed = problem.log();
  const std::vector<double>& left = outcome.figures.fit.residuals.front();
  for (std::size_t i = 0; i < left.size(); ++i) {
    outcome.plot.add(pressed.time[i], pressed.force[i], left[i]);
  }
  return outcome;
}

}  // namespace hvp::app
