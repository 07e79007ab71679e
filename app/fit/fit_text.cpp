#include <cmath>
#include <string>

#include <fmt/format.h>

#include "app/fit/fit_figures.h"
#include "app/results/number_text.h"

namespace hvp::app {

namespace {

// As many digits as its interval means something of, and two more.
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

}  // namespace

std::string fit_text(const FitFigures& figures) {
  const fit::Fit& fit = figures.fit;
  std::string text = fmt::format("{} fitted to {}, {}\n\n", figures.model, figures.log,
                                 results::counted(figures.samples, "sample"));
  text +=
      fmt::format("  {:<20} {:>12}  {:<26} {}\n", "parameter", "value", "95 % interval", "unit");
  for (const fit::Estimate& e : fit.parameters) text += line_of(e);
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

}  // namespace hvp::app
