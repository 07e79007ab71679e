#include "app/fit/fit_figures.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "app/results/number_text.h"
#include "models/files/one_line.h"

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
  if (!e.between) return;
  f.table("between", "Of several logs, or of the quarters of one that disagree.", [&] {
    number("deviation", e.between->deviation,
           "the standard deviation of what the logs' own noise does not explain");
    number("next_low", e.between->next_low, "of what the fit of another such log would give, 95 %");
    number("next_high", e.between->next_high, "likewise");
    f.ratio("probability", e.between->probability,
            "of so much disagreement among logs that differ by their noise alone (Cochran 1954)");
  });
}

}  // namespace

void FitFigures::report(config::Figures& f) const {
  f.text("model", model, "that was fitted");
  f.text("log", log, "the file's name; of several, with commas between");
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
  f.list("logs", "each of several; none of one", logs, [&](const OneLog& one) {
    f.text("log", one.log, "the file's name");
    f.count("samples", one.samples, "that were fitted");
    f.quantity("residual_rms", one.residual_rms, residual_unit, "of this log");
    f.value("values", one.values, {},
            "that it gives the parameters, in their order; null: it does not");
  });
  f.value("warnings", warnings, {}, "what to know before trusting the values");
}

namespace {

// Writes the digits that are significant in view of the interval, and two more.
std::string digits(double value, double width) {
  if (value == 0) return "0";
  const double share = width > 0 ? std::abs(value) / width : 1e6;
  const int significant = std::clamp(static_cast<int>(std::ceil(std::log10(share + 1))) + 2, 3, 9);
  return fmt::format("{:.{}g}", value, significant);
}

std::string line_of(const fit::Estimate& e) {
  const double width = e.high - e.low;
  std::string interval = fmt::format("{} to {}", digits(e.low, width), digits(e.high, width));
  if (e.fixed) interval = "fixed";
  if (!e.identifiable) interval = "not given by this log";
  return fmt::format("  {:<20} {:>12}  {:<26} {}\n", e.name, digits(e.value, width), interval,
                     e.unit);
}

// What lies between several logs, and the value of each.
std::string logs_text(const FitFigures& figures) {
  if (figures.logs.empty()) return {};
  std::string text = fmt::format("\n  {:<20} {:>12}", "of each log", "between");
  std::size_t width = 12;
  for (const FitFigures::OneLog& log : figures.logs) width = std::max(width, log.log.size());
  for (const FitFigures::OneLog& log : figures.logs)
    text += fmt::format("  {:>{}}", log.log, width);
  text += '\n';
  for (std::size_t p = 0; p < figures.fit.parameters.size(); ++p) {
    const fit::Estimate& e = figures.fit.parameters[p];
    text += fmt::format("  {:<20} {:>12}", e.name,
                        e.between ? fmt::format("{:.3g}", e.between->deviation) : "-");
    for (const FitFigures::OneLog& log : figures.logs) {
      const double value = log.values[p];
      text +=
          fmt::format("  {:>{}}", std::isnan(value) ? "-" : digits(value, e.high - e.low), width);
    }
    text += '\n';
  }
  return text;
}

}  // namespace

std::string fit_text(const FitFigures& figures) {
  const fit::Fit& fit = figures.fit;
  std::string text = fmt::format("{} fitted to {}, {}\n\n", figures.model, figures.log,
                                 results::counted(figures.samples, "sample"));
  text +=
      fmt::format("  {:<20} {:>12}  {:<26} {}\n", "parameter", "value", "95 % interval", "unit");
  for (const fit::Estimate& e : fit.parameters) text += line_of(e);
  text += logs_text(figures);
  text += fmt::format("\n  left over  {:.4g} {} rms", fit.residual_rms, figures.residual_unit);
  if (fit.held_out_rms) {
    text += fmt::format("; {:.4g} {} of what was held out and predicted", *fit.held_out_rms,
                        figures.residual_unit);
  }
  text += fmt::format("\n  starts     {} of {} reached this optimum\n", fit.starts.reached,
                      fit.starts.tried);
  if (!figures.warnings.empty()) text += '\n';
  for (const std::string& warning : figures.warnings) text += fmt::format("  note: {}\n", warning);
  return text;
}

namespace {

const fit::Estimate* find(const FitFigures& figures, const std::string& name) {
  const std::vector<fit::Estimate>& all = figures.fit.parameters;
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const fit::Estimate& e) { return e.name == name; });
  return found == all.end() ? nullptr : &*found;
}

std::string interval(const fit::Estimate& e) {
  if (e.fixed) return "fixed";
  return fmt::format("95 %: {:.6g} to {:.6g} {}", e.low, e.high, e.unit);
}

}  // namespace

std::string toml_quantity(double value, std::string_view unit) {
  return fmt::format("\"{} {}\"", results::shortest(value), unit);
}

std::string fitted_toml(const FitFigures& figures, const std::vector<FittedSetting>& settings) {
  std::string text =
      fmt::format("# {} fitted to {} by hvp fit: {:.4g} {} rms left over{}\n", figures.model,
                  files::one_line(figures.log), figures.fit.residual_rms, figures.residual_unit,
                  figures.fit.converged ? "" : ", NOT CONVERGED");
  for (const std::string& w : figures.warnings) {
    text += fmt::format("# note: {}\n", files::one_line(w, 1000));
  }
  for (const fit::Estimate& e : figures.fit.parameters) {
    const bool used = std::any_of(settings.begin(), settings.end(),
                                  [&](const FittedSetting& s) { return s.parameter == e.name; });
    if (!used) text += fmt::format("# {} = {:.6g} {} ({})\n", e.name, e.value, e.unit, interval(e));
  }
  // Each table appears once, at the place of its first key.
  std::vector<FittedSetting> ordered;
  for (const FittedSetting& of : settings) {
    const bool first = std::none_of(ordered.begin(), ordered.end(),
                                    [&](const FittedSetting& s) { return s.table == of.table; });
    if (!first) continue;
    std::copy_if(settings.begin(), settings.end(), std::back_inserter(ordered),
                 [&](const FittedSetting& s) { return s.table == of.table; });
  }
  std::string table;
  for (const FittedSetting& s : ordered) {
    const fit::Estimate* e = find(figures, s.parameter);
    if (s.table != table) text += fmt::format("\n[{}]\n", s.table);
    table = s.table;
    const bool given = e == nullptr || e->identifiable;
    text += fmt::format("{}{} = {}", given ? "" : "# ", s.key, s.value);
    if (e != nullptr) {
      const std::string of = s.derived ? fmt::format("from {}, ", e->name) : "";
      text += fmt::format("  # {}", given ? of + interval(*e) : "not given by this log");
    }
    text += '\n';
  }
  return text;
}

}  // namespace hvp::app
