#include <charconv>
#include <cstdio>
#include <system_error>

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/commands/terminal.h"
#include "app/fit/fit_request.h"
#include "app/results/figures_json.h"
#include "app/results/interruption.h"
#include "app/results/number_text.h"
#include "app/results/part_file.h"
#include "app/results/pictures.h"
#include "models/files/one_line.h"

namespace hvp::app {

namespace {

// "mass=0.1"
std::pair<std::string, double> fixed_value(const std::string& text) {
  const std::size_t equals = text.find('=');
  double value = 0;
  const char* end = text.data() + text.size();
  const char* begin = equals == std::string::npos ? end : text.data() + equals + 1;
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (equals == 0 || equals == std::string::npos || error != std::errc() || stop != end) {
    throw InputError(fmt::format("--fix {}: expected NAME=NUMBER, in the parameter's unit",
                                 files::one_line(text)));
  }
  return {text.substr(0, equals), value};
}

// Before the fit, not after it.
void require_writable(const char* option, const std::filesystem::path& file,
                      std::string_view ending) {
  if (file.empty()) return;
  const std::string shown = files::one_line(file.string());
  if (file.extension() != ending) {
    throw InputError(
        fmt::format("{} {}: expected a file name that ends in {}", option, shown, ending));
  }
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  if (!std::filesystem::is_directory(folder)) {
    throw InputError(fmt::format("{} {}: there is no folder {}", option, shown,
                                 files::one_line(folder.string())));
  }
}

FitRequest request_of(const FitArguments& a) {
  FitRequest request;
  request.log = a.log;
  request.reading.columns = a.columns;
  request.reading.sample_rate = a.sample_rate;
  request.reading.count_size = a.count_size;
  request.reading.count_unit = a.count_unit;
  request.overrides = a.overrides;
  if (!a.scenario.empty()) {
    ScenarioArguments arguments;
    arguments.scenario = a.scenario;
    request.scenario = load(arguments).scenario;
  }
  for (const std::string& text : a.fixed) {
    if (request.options.fixed.insert(fixed_value(text)).second) continue;
    throw InputError(fmt::format("--fix {}: it is fixed twice", files::one_line(text)));
  }
  request.options.hold_out = a.hold_out;
  request.options.starts = a.starts;
  request.options.loss = a.loss == "huber"    ? fit::Loss::huber
                         : a.loss == "cauchy" ? fit::Loss::cauchy
                                              : fit::Loss::squares;
  request.options.seed = a.seed;
  const Progress progress = make_progress(a.quiet);
  request.options.progress = [progress](const fit::Attempt& at) {
    if (progress) {
      progress(fmt::format("start {} of {}, iteration {}, {:.4g} rms", at.start, at.starts,
                           at.iteration, at.rms));
    }
    return results::interrupted() == 0;
  };
  return request;
}

std::string title_of(const FitFigures& figures) {
  constexpr std::size_t kLongest = 80;
  std::string title = fmt::format("{} of {}", figures.model, figures.log);
  const char* before = ": ";
  for (const fit::Estimate& e : figures.fit.parameters) {
    if (e.fixed || !e.identifiable || title.size() > kLongest) continue;
    title +=
        fmt::format("{}{} {:.4g}{}{}", before, e.name, e.value, e.unit.empty() ? "" : " ", e.unit);
    before = ", ";
  }
  return title;
}

std::string plot_csv(const FitOutcome& outcome) {
  const FitPlot& p = outcome.plot;
  std::string text = fmt::format("# {}\nx,observed,modelled,residual\n",
                                 files::one_line(title_of(outcome.figures), 200));
  for (std::size_t i = 0; i < p.x.size(); ++i) {
    if (p.x[i] != p.x[i]) {
      text += ",,,\n";
      continue;
    }
    text += fmt::format(
        "{},{},{},{}\n", results::shortest(p.x[i]), results::shortest(p.observed[i]),
        results::shortest(p.observed[i] - p.residual[i]), results::shortest(p.residual[i]));
  }
  return text;
}

std::filesystem::path samples_beside(std::filesystem::path png) {
  return png.replace_extension(".fit.csv");
}

// The picture's samples stay beside it.
bool draw(const FitOutcome& outcome, const std::filesystem::path& png) {
  const std::filesystem::path csv = samples_beside(png);
  results::write_through_part_file(csv, plot_csv(outcome));
  const FitPlot& p = outcome.plot;
  const results::PictureOutcome drawn = results::draw_fit(csv, png, {p.x_label, p.y_label, p.unit});
  if (!drawn.drawn) complain(fmt::format("hvp: {}", drawn.reason));
  return drawn.drawn;
}

}  // namespace

int fit_command(const FitArguments& arguments) {
  require_writable("--out", arguments.out, ".toml");
  require_writable("--plot", arguments.plot, ".png");
  const FitModel& model = fit_model(arguments.model);
  const FitRequest request = request_of(arguments);
  const results::DeferredInterruption deferred;
  const FitOutcome outcome = model.fit(request);
  end_progress(arguments.quiet);
  if (arguments.json) {
    print("{}\n", results::figures_json(outcome.figures).dump(2));
  } else {
    print_text(fit_text(outcome.figures));
  }
  if (!arguments.out.empty()) {
    results::write_through_part_file(arguments.out, fitted_toml(outcome.figures, outcome.settings));
  }
  const bool draws = !arguments.plot.empty() && results::interrupted() == 0;
  if (draws && !draw(outcome, arguments.plot)) return kFailed;
  if (results::interrupted() != 0) {
    std::fflush(stdout);
    results::end_as_interrupted();
  }
  return outcome.figures.fit.converged ? kHeld : kNotHeld;
}

}  // namespace hvp::app
