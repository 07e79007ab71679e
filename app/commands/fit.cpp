#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/commands/number_check.h"
#include "app/fit/fit_request.h"
#include "app/fit/several_logs.h"
#include "app/results/figures.h"
#include "app/results/number_text.h"
#include "app/results/part_files.h"
#include "app/results/pictures.h"
#include "models/files/one_line.h"

namespace hvp::app {

namespace {

struct FitArguments {
  std::vector<std::filesystem::path> logs;
  std::string model;
  std::filesystem::path out;   // a table for a scenario; empty: none
  std::filesystem::path plot;  // a picture; empty: none
  bool json = false;
  bool quiet = false;
  double hold_out = 0.2;
  int starts = 8;
  std::string loss = "squares";
  std::uint64_t seed = 1;
  std::vector<std::string> fixed;     // --fix NAME=VALUE
  std::vector<std::string> columns;   // --column QUANTITY_UNIT=NAME
  std::optional<double> sample_rate;  // Hz
  std::optional<double> count_size;   // of a position in counts
  std::string count_unit = "rad";
  std::vector<std::string> overrides;  // --set KEY=VALUE, of the model
  std::filesystem::path scenario;      // of a body
};

// Parses "mass=0.1".
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

// Checks an output file before the fit, so that no result is lost.
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

FitRequest request_of(const FitArguments& a, const std::filesystem::path& log) {
  FitRequest request;
  request.log = log;
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
  request.out_folder = a.out.parent_path();
  request.options.hold_out = a.hold_out;
  request.options.starts = a.starts;
  request.options.loss = a.loss == "huber"    ? fit::Loss::huber
                         : a.loss == "cauchy" ? fit::Loss::cauchy
                                              : fit::Loss::squares;
  request.options.seed = a.seed;
  const Progress progress = make_progress(a.quiet);
  const std::string of = a.logs.size() > 1 ? log.filename().string() + ": " : "";
  request.options.progress = [progress, of](const fit::Attempt& at) {
    if (progress) {
      progress(fmt::format("{}start {} of {}, iteration {}, {:.4g} rms", of, at.start, at.starts,
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

// The samples stay beside the picture.
bool draw(const FitOutcome& outcome, const std::filesystem::path& png) {
  const std::filesystem::path csv = samples_beside(png);
  results::write_through_part_file(csv, plot_csv(outcome));
  const FitPlot& p = outcome.plot;
  const results::PictureOutcome drawn = results::draw_fit(csv, png, {p.x_label, p.y_label, p.unit});
  if (!drawn.drawn) complain(fmt::format("hvp: {}", drawn.reason));
  return drawn.drawn;
}

// Returns status 1 if the search did not converge.
int fit_command(const FitArguments& arguments) {
  require_writable("--out", arguments.out, ".toml");
  require_writable("--plot", arguments.plot, ".png");
  const FitModel& model = fit_model(arguments.model);
  const auto request = [&](const std::filesystem::path& log) { return request_of(arguments, log); };
  const results::DeferredInterruption deferred;
  const FitOutcome outcome = fit_logs(model, arguments.logs, request);
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

}  // namespace

void add_fit(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<FitArguments>();
  CLI::App* command = app.add_subcommand(
      "fit", "parameters of a device, a hand, tissue, a bus or a host from a log, with intervals");
  command
      ->add_option(
          "log", arguments->logs,
          "a CSV file whose columns are named time_s, force_N, travel_mm …; of several the "
          "intervals hold what lies between them")
      ->required()
      ->type_name("LOG.csv");
  command->add_option("--model", arguments->model, "device, hand, qlv, tissue, bus or host")
      ->required()
      ->type_name("NAME");
  command->add_option("--out", arguments->out, "write a table that a scenario takes with `include`")
      ->type_name("FILE.toml");
  command->add_flag("--json", arguments->json, "as one JSON object");
  command
      ->add_option("--plot", arguments->plot,
                   "draw log, model and what is left over; samples beside it")
      ->type_name("FILE.png");
  command
      ->add_option("--hold-out", arguments->hold_out,
                   "share of the log that another fit has to predict, 0.2 by default")
      ->check(number_between(0.0, 0.9))
      ->type_name("SHARE");
  command->add_option("--fix", arguments->fixed, "a parameter's value is known; as often as wanted")
      ->allow_extra_args(false)
      ->type_name("NAME=VALUE");
  command
      ->add_option("--column", arguments->columns,
                   "a quantity is in a column of another name, or number; as often as wanted")
      ->allow_extra_args(false)
      ->type_name("QUANTITY_UNIT=NAME");
  command->add_option("--rate", arguments->sample_rate, "samples a second, of a log without a time")
      ->check(number_between(1e-3, 1e8))
      ->type_name("HZ");
  command->add_option("--count", arguments->count_size, "what a count of position_counts is")
      ->check(number_between(1e-12, 1e3))
      ->type_name("SIZE");
  command->add_option("--count-unit", arguments->count_unit, "its unit, rad by default")
      ->check(CLI::IsMember({"m", "rad"}))
      ->type_name("UNIT");
  command->add_option("--starts", arguments->starts, "searches from different places, 8 by default")
      ->check(CLI::Range(1, 1000))
      ->type_name("N");
  command
      ->add_option("--loss", arguments->loss,
                   "squares, or huber or cauchy, for which outliers weigh less; of a bus cauchy")
      ->check(CLI::IsMember({"squares", "huber", "cauchy"}))
      ->type_name("NAME");
  command->add_option("--seed", arguments->seed, "of the searches' places, 1 by default")
      ->type_name("N");
  command
      ->add_option("--set", arguments->overrides,
                   "gives a setting of the model another value, such as elastic")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  command->add_option("--scenario", arguments->scenario, "whose body the log is of: model tissue")
      ->type_name("FILE.toml");
  command->add_flag("--quiet", arguments->quiet, "no progress on the terminal");
  command->callback([arguments, &status] { status = fit_command(*arguments); });
}

}  // namespace hvp::app
