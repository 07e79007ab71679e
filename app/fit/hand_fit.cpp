#include "app/fit/fit_request.h"
#include "app/fit/model_settings.h"
#include "models/config/declaration.h"
#include "models/fit/hand_problem.h"

namespace hvp::app {

namespace {

struct HandFitSettings : fit::HandOptions {
  void declare(config::Visitor& v) {
    v.quantity("window", window, config::Dimension::time, config::between(0.05, 60),
               {"each has a position and a velocity of its own to begin with",
                "two periods of a hand's slowest own motion"});
    v.quantity("bandwidth", bandwidth, config::Dimension::frequency, config::between(0, 20),
               {"of an intended motion that is not in the log",
                "voluntary motion of an arm is mostly below 2 Hz"});
  }
};

}  // namespace

FitOutcome fit_hand(const FitRequest& request) {
  const auto settings = model_settings<HandFitSettings>(request.overrides);
  const files::Log log =
      longest_stretch(request.read({"force", "position", "displacement", "intended"}));
  const files::LogColumn& position =
      log.column(log.find("displacement") != nullptr ? "displacement" : "position", "m");
  fit::HandLog hand{log.spacing.period, log.column("force", "N").values, position.values, {}};
  if (log.find("intended") != nullptr) hand.intended = log.column("intended", "m").values;
  const fit::HandProblem problem(hand, settings);

  FitOutcome outcome;
  outcome.figures = figures_of("hand", log, problem.unit(), fit::fit(problem, request.options),
                               problem.warnings());
  const fit::Fit& fit = outcome.figures.fit;
  outcome.settings = {{"hand", "model", "\"custom\"", ""}};
  for (const auto& [key, unit] :
       {std::pair{"mass", "kg"}, {"stiffness", "N/m"}, {"damping", "N s/m"}}) {
    outcome.settings.push_back({"hand", key, toml_quantity(estimate(fit, key).value, unit), key});
  }
  outcome.plot = {"time (s)", "position", "m", {}, {}, {}};
  outcome.plot.add_stretches(log.time, position.values, fit.residuals);
  return outcome;
}

}  // namespace hvp::app
