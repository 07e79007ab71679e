#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/commands/number_check.h"
#include "app/measure/host_times.h"
#include "app/results/number_text.h"
#include "app/results/part_files.h"
#include "app/scenario/writer.h"
#include "models/config/input_error.h"
#include "models/files/latencies.h"
#include "models/fit/processor_fit.h"
#include "models/fit/tail_fit.h"
#include "models/fit/wake_up_histogram.h"
#include "models/random/distribution.h"

namespace hvp::app {

namespace {

// A model that is further from a size that it has not seen is said to be.
constexpr double kAccepted = 1.2;

struct MeasureArguments {
  std::filesystem::path out = "host.toml";
  double seconds = 30;  // of ticks
  bool quiet = false;
};

// The keys of a host that are measured, as a file that a scenario includes.
struct MeasuredHost {
  host::Processor processor;
  std::optional<random::TimeDistribution> wake_up;

  struct Table {
    MeasuredHost& host;
    void declare(config::Visitor& v) {
      auto model = host::ProcessorModel::measured;
      v.choice("model", model, {{"measured", host::ProcessorModel::measured}}, {.help = "this"});
      v.table("processor", host.processor, {"as measured"});
      v.effect("wake_up", host.wake_up, {"as measured", "", {}});
    }
  };
  void declare(config::Visitor& v) {
    Table table{*this};
    v.table("host", table, {"as measured"});
  }
};

double three_digits(double value) {
  if (!(value > 0)) return 0;
  return std::strtod(fmt::format("{:.2e}", value).c_str(), nullptr);
}

host::Processor rounded(host::Processor p) {
  for (double* value : {&p.call_s, &p.dense_flops, &p.single_flops, &p.sparse_flops,
                        &p.triangular_flops, &p.memory_bandwidth}) {
    *value = three_digits(*value);
  }
  for (auto& cache : p.caches) cache.bandwidth = three_digits(cache.bandwidth);
  p.caches.back().size_bytes = three_digits(p.caches.back().size_bytes);
  return p;
}

std::string time_of(double seconds) { return results::readable_time(std::llround(seconds * 1e12)); }

std::string csv_of(const std::vector<fit::SolveTime>& times, const fit::ProcessorFit& fitted) {
  std::string text =
      "solver,unknowns,dense,dense_single,sparse,triangular,bytes,working_set_bytes,measured_s,"
      "predicted_s,held_out\n";
  for (std::size_t i = 0; i < times.size(); ++i) {
    const fit::SolveTime& t = times[i];
    text += fmt::format("{},{},{},{},{},{},{},{},{:.4g},{:.4g},{}\n", t.solver, t.unknowns,
                        t.work.dense, t.work.dense_single, t.work.sparse, t.work.triangular,
                        t.work.bytes, t.working_set, t.seconds, fitted.predictions[i].seconds,
                        t.held_out ? 1 : 0);
  }
  return text;
}

void print_times(const std::vector<fit::SolveTime>& times, const fit::ProcessorFit& fitted) {
  print("  {:<24} {:>8}  {:>12}  {:>12}\n", "solver", "unknowns", "measured", "predicted");
  for (std::size_t i = 0; i < times.size(); ++i) {
    const fit::SolveTime& t = times[i];
    print("  {:<24} {:>8}  {:>12}  {:>12}  {:+4.0f} %{}\n", t.solver, t.unknowns,
          time_of(t.seconds), time_of(fitted.predictions[i].seconds),
          100 * (fitted.predictions[i].ratio - 1), t.held_out ? "  held out" : "");
  }
}

// The tail of the latencies, where they have one: a longer watch would have seen longer ones.
// Returns what to say of it.
std::string take_tail(const WakeUps& wake_ups, random::TimeDistribution& d) {
  try {
    const fit::WakeUpTail tail =
        fit::fit_tail(fit::histogram_of(files::read_latencies(wake_ups.csv())), std::nullopt);
    if (!tail.fit.converged || !tail.fit.warnings.empty()) {
      return "; their tail is as measured: no threshold has one that a distribution fits";
    }
    const auto value = [&](std::string_view name) -> const fit::Estimate& {
      return *std::ranges::find(tail.fit.parameters, name, &fit::Estimate::name);
    };
    d.tail = random::TimeDistribution::Tail::pareto;
    d.tail_from_s = tail.from_s;
    d.tail_scale_s = three_digits(value("tail_scale").value);
    d.tail_shape = std::strtod(fmt::format("{:.3f}", value("tail_shape").value).c_str(), nullptr);
    const fit::Estimate& rare = tail.fit.parameters.back();
    return fmt::format(
        "; beyond {} a tail of shape {:.2f}, of which {} of all are longer than {} "
        "(95 %: {} to {})",
        time_of(tail.from_s), d.tail_shape, rare.name.substr(rare.name.find('_') + 1),
        time_of(rare.value), time_of(rare.low), time_of(rare.high));
  } catch (const InputError&) {
    return "; their tail is as measured: too few are long";
  }
}

int measure_host(const MeasureArguments& arguments) {
  if (arguments.out.extension() != ".toml") {
    throw InputError("--out " + arguments.out.string() + ": expected a name that ends in .toml");
  }
  std::error_code error;
  if (const auto folder = arguments.out.parent_path();
      !folder.empty() && !std::filesystem::is_directory(folder, error)) {
    throw InputError("--out " + arguments.out.string() + ": there is no folder " + folder.string());
  }
  const Progress progress = make_progress(arguments.quiet);
  const WakeUps wake_ups = time_wake_ups(arguments.seconds, progress);
  const std::vector<fit::SolveTime> times = time_solves(progress);
  end_progress(arguments.quiet);
  const fit::ProcessorFit fitted = fit::fit_processor(times, caches_of_this_machine());

  std::filesystem::path samples = arguments.out;
  samples.replace_extension(".wake-up.csv");
  MeasuredHost measured{rounded(fitted.processor), random::TimeDistribution{}};
  measured.wake_up->kind = random::TimeDistribution::Kind::measured;
  measured.wake_up->samples_file = config::File(samples.filename().string());
  measured.wake_up->maximum_s = std::max(measured.wake_up->maximum_s, wake_ups.longest_s());
  const std::string tail = take_tail(wake_ups, *measured.wake_up);
  // Its first line speaks of a whole scenario.
  std::string tables = scenario::resolved(measured);
  tables.erase(0, tables.find('\n') + 1);
  const std::string name = processor_name();
  std::filesystem::path solves = arguments.out;
  solves.replace_extension(".solves.csv");
  results::write_through_part_file(samples, wake_ups.csv());
  results::write_through_part_file(solves, csv_of(times, fitted));
  results::write_through_part_file(
      arguments.out, fmt::format("# A host that was measured{}{}: include it in a scenario.\n",
                                 name.empty() ? "" : ": ", name) +
                         tables);

  print("{}\n\n", name.empty() ? "this machine" : name);
  print_times(times, fitted);
  print("\n  wake-up with every core busy: {} ticks, longest {}{}{}\n", wake_ups.ticks,
        time_of(wake_ups.longest_s()),
        wake_ups.real_time ? ", at a real-time priority"
                           : ", without a real-time priority: this user has none",
        tail);
  print("\n{} and {}: a scenario takes them by --include {}; the solves are in {}\n",
        arguments.out.string(), samples.string(), arguments.out.string(), solves.string());
  if (fitted.worst_held_out <= kAccepted) return kHeld;
  print(
      "\nAttention: of a size that the model has not seen it is off by up to {:.0f} %, which is "
      "more than 20 %: is something else running?\n",
      100 * (fitted.worst_held_out - 1));
  return kNotHeld;
}

}  // namespace

void add_measure(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand("measure", "measure what scenarios ask about a machine");
  command->require_subcommand(1);
  const auto arguments = std::make_shared<MeasureArguments>();
  CLI::App* host = command->add_subcommand(
      "host", "how fast this machine solves and how late it wakes, as a file to include");
  host->add_option("--out", arguments->out, "file to write")
      ->capture_default_str()
      ->type_name("FILE.toml");
  host->add_option("--seconds", arguments->seconds, "how long to watch the wake-ups")
      ->capture_default_str()
      ->check(number_between(1.0, 36000.0));
  host->add_flag("--quiet", arguments->quiet, "no progress on the terminal");
  host->callback([arguments, &status] { status = measure_host(*arguments); });
}

}  // namespace hvp::app
