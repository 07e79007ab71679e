#include "app/fit/fit_figures.h"

#include <optional>

namespace hvp::app {

namespace {

void report_parameter(config::Figures& f, const fit::Estimate& e) {
  const auto number = [&](std::string_view key, double value, std::string_view help) {
    f.quantity(key, value, e.unit, help);
  };
  f.text("name", e.name, "of the parameter");
  number("value", e.value, "in `unit`, as `low` and `high`");
  f.text("unit", e.unit, "empty: none");
  number("low", e.low, "of the 95 % interval, which holds for residuals that are alike in time");
  number("high", e.high, "likewise");
  f.truth("identifiable", e.identifiable,
          "whether the interval is narrower than the value, or than what would show in this log");
  f.truth("fixed", e.fixed, "by `--fix`, or because two parameters cannot both be had");
  f.truth("at_bound", e.at_bound, "the value is the largest or smallest one that is admitted");
  f.truth("profiled", e.profiled,
          "the problem is not close to linear: the interval is from the profile of the sum of "
          "squares");
  f.text("remedy", e.remedy, "not identifiable: the log that would give it");
}

}  // namespace

void FitFigures::report(config::Figures& f) const {
  f.text("model", model, "that was fitted");
  f.text("log", log, "the file's name");
  f.count("samples", samples, "that were fitted");
  f.list("parameters", "what was asked for", fit.parameters,
         [&](const fit::Estimate& e) { report_parameter(f, e); });
  f.quantity("residual_rms", fit.residual_rms, residual_unit, "of the whole log");
  f.quantity("held_out_rms", fit.held_out_rms, residual_unit,
             "of the part that another fit did not see and predicted; null without one");
  f.text("residual_unit", residual_unit, "of both");
  f.table("starts", "searches from several places", [&] {
    f.count("tried", fit.starts.tried, "searches");
    f.count("reached", fit.starts.reached, "of them ended in the best optimum");
    f.list("others", "worse optima, the best first", fit.starts.others,
           [&](const fit::Starts::Other& other) {
             f.quantity("residual_rms", other.rms, residual_unit, "there");
             f.count("times", other.times, "how many searches ended there");
             f.value("values", other.values, {}, "of the parameters there, in their order");
           });
  });
  f.truth("converged", fit.converged, "the best search came to an end");
  f.truth("interrupted", fit.interrupted, "by Ctrl-C");
  f.table("residuals", "what is left over", [&] {
    f.truth("white", fit.whiteness.white(), "neighbours are not alike (Ljung & Box 1978, 1 %)");
    f.ratio("probability", fit.whiteness.probability, "of so much likeness in white noise");
    f.count("lags", fit.whiteness.lags, "that were looked at");
    f.count("noise_order", fit.noise_order,
            "of the autoregressive model of them on which the intervals rest");
    f.ratio("widened", fit.widened,
            "the largest factor by which that makes an interval wider than white noise would");
  });
  std::vector<std::vector<double>> rows;
  for (Eigen::Index i = 0; i < fit.correlations.rows(); ++i) {
    rows.emplace_back(fit.correlations.row(i).begin(), fit.correlations.row(i).end());
  }
  f.list("correlations", "of the parameters that are not fixed, a row each", rows,
         [&](const std::vector<double>& row) {
           f.value("row", row, {}, "with each of them, in their order");
         });
  f.value("warnings", warnings, {}, "what to know before trusting the values");
}

}  // namespace hvp::app
