#include "app/fit/several_logs.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/files/one_line.h"
#include "models/fit/between_logs.h"

namespace hvp::app {

namespace {

// Half of a 95 % interval over the standard deviation.
constexpr double kNormal = 1.959964;
// Logs that agree so seldom by chance disagree.
constexpr double kDisagree = 0.01;

void require_different(const std::vector<std::filesystem::path>& logs) {
  for (std::size_t i = 0; i < logs.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      std::error_code none;
      if (!std::filesystem::equivalent(logs[i], logs[j], none)) continue;
      throw InputError(fmt::format("{}: the log is given twice: expected another record",
                                   files::one_line(logs[i].string())));
    }
  }
}

void add_name(std::string& names, const std::string& name) {
  names += (names.empty() ? "" : ", ") + name;
}

void require_alike(const std::vector<FitOutcome>& outcomes) {
  const FitFigures& first = outcomes.front().figures;
  for (const FitOutcome& other : outcomes) {
    if (other.figures.residual_unit == first.residual_unit) continue;
    throw InputError(fmt::format("{} is fitted in {} and {} in {}: expected logs of one kind",
                                 first.log, first.residual_unit, other.figures.log,
                                 other.figures.residual_unit));
  }
}

// Null where the log has no such parameter, as reads alone have no write_latency.
const fit::Estimate* find(const FitOutcome& outcome, const std::string& name) {
  const auto& all = outcome.figures.fit.parameters;
  const auto found = std::ranges::find(all, name, &fit::Estimate::name);
  return found == all.end() ? nullptr : &*found;
}

// The parameters of all logs, each once.
std::vector<std::string> names_of(const std::vector<FitOutcome>& outcomes) {
  std::vector<std::string> names;
  for (const FitOutcome& outcome : outcomes) {
    for (const fit::Estimate& e : outcome.figures.fit.parameters) {
      if (std::ranges::count(names, e.name) == 0) names.push_back(e.name);
    }
  }
  return names;
}

// In its logarithm where every log says that it is positive, so that no interval is below zero.
fit::BetweenLogs combined(const std::vector<const fit::Estimate*>& given) {
  const bool positive =
      std::ranges::all_of(given, [](const fit::Estimate* e) { return e->low > 0; });
  std::vector<fit::OfOneLog> logs;
  for (const fit::Estimate* e : given) {
    const double least = 1e-12 * std::abs(e->value) + 1e-300;  // of one at both its bounds
    const double width = positive ? std::log(e->high / e->low) : e->high - e->low;
    logs.push_back({positive ? std::log(e->value) : e->value,
                    std::max(width / 2 / kNormal, positive ? 1e-12 : least)});
  }
  fit::BetweenLogs b = fit::between_logs(logs);
  if (!positive) return b;
  for (double* value : {&b.value, &b.low, &b.high, &b.next_low, &b.next_high}) {
    *value = std::exp(*value);
  }
  b.deviation *= b.value;
  return b;
}

// Names of parameters, for notes.
struct Named {
  std::string disagree;                      // of which the logs contradict each other
  std::map<std::string, std::string> alone;  // log -> what it alone gives
};

// The parameter of all logs that have it.
fit::Estimate estimate_of(const std::vector<FitOutcome>& outcomes, const std::string& name,
                          Named& named) {
  std::vector<const fit::Estimate*> given;
  std::string by;
  fit::Estimate all;
  for (const FitOutcome& outcome : outcomes) {
    const fit::Estimate* e = find(outcome, name);
    if (e == nullptr) continue;
    if (all.name.empty()) all = *e;
    if (e->fixed || !e->identifiable) continue;
    given.push_back(e);
    by = outcome.figures.log;
  }
  if (given.empty()) return all;
  if (given.size() == 1) {
    add_name(named.alone[by], all.name);
    return *given.front();
  }
  all.between = combined(given);
  all.value = all.between->value;
  all.low = all.between->low;
  all.high = all.between->high;
  all.identifiable = true;
  all.remedy.clear();
  all.profiled = false;
  all.at_bound = std::ranges::any_of(given, &fit::Estimate::at_bound);
  if (all.between->probability < kDisagree) add_name(named.disagree, all.name);
  return all;
}

// Logs of one name, such as frames.csv of several runs, get as much of their folders as tells them
// apart.
void tell_apart(std::vector<FitOutcome>& outcomes, const std::vector<std::filesystem::path>& logs) {
  std::vector<std::filesystem::path> names;
  std::vector<std::filesystem::path> folders;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    names.push_back(logs[i].filename());
    folders.push_back(std::filesystem::absolute(logs[i]).lexically_normal().parent_path());
  }
  const auto alike = [&] {
    std::vector<std::size_t> same;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (std::ranges::count(names, names[i]) > 1) same.push_back(i);
    }
    return same;
  };
  for (std::vector<std::size_t> same = alike(); !same.empty(); same = alike()) {
    for (const std::size_t i : same) {
      if (!folders[i].has_filename()) return;
      names[i] = folders[i].filename() / names[i];
      folders[i] = folders[i].parent_path();
    }
  }
  for (std::size_t i = 0; i < outcomes.size(); ++i) outcomes[i].figures.log = names[i].string();
}

// Root of the mean square over all samples.
std::optional<double> pooled(const std::vector<FitOutcome>& outcomes,
                             const std::function<std::optional<double>(const fit::Fit&)>& rms) {
  double squares = 0;
  double samples = 0;
  for (const FitOutcome& outcome : outcomes) {
    const std::optional<double> one = rms(outcome.figures.fit);
    if (!one) return std::nullopt;
    const auto count = static_cast<double>(outcome.figures.samples);
    squares += count * *one * *one;
    samples += count;
  }
  return std::sqrt(squares / samples);
}

// A note that all logs have is said once.
std::vector<std::string> notes_of(const std::vector<FitOutcome>& outcomes) {
  std::vector<std::string> notes;
  for (const FitOutcome& outcome : outcomes) {
    for (const std::string& note : outcome.figures.warnings) {
      const bool shared = std::ranges::all_of(outcomes, [&](const FitOutcome& other) {
        return std::ranges::count(other.figures.warnings, note) > 0;
      });
      const bool named = shared || note.find(outcome.figures.log) != std::string::npos;
      const std::string said = named ? note : fmt::format("{}: {}", outcome.figures.log, note);
      if (std::ranges::count(notes, said) == 0) notes.push_back(said);
    }
  }
  return notes;
}

FitFigures figures_of_all(const std::vector<FitOutcome>& outcomes) {
  FitFigures all;
  const FitFigures& first = outcomes.front().figures;
  all.model = first.model;
  all.residual_unit = first.residual_unit;
  fit::Fit& fit = all.fit;
  fit.converged = true;
  fit.whiteness = first.fit.whiteness;
  fit.widened = 0;
  const std::vector<std::string> names = names_of(outcomes);
  for (const FitOutcome& outcome : outcomes) {
    const FitFigures& of = outcome.figures;
    all.log += (all.log.empty() ? "" : ", ") + of.log;
    all.samples += of.samples;
    std::vector<double> values;
    for (const std::string& name : names) {
      const fit::Estimate* e = find(outcome, name);
      const bool given = e != nullptr && e->identifiable;
      values.push_back(given ? e->value : std::numeric_limits<double>::quiet_NaN());
    }
    all.logs.push_back({of.log, of.samples, of.fit.residual_rms, values});
    fit.starts.tried += of.fit.starts.tried;
    fit.starts.reached += of.fit.starts.reached;
    fit.converged = fit.converged && of.fit.converged;
    fit.interrupted = fit.interrupted || of.fit.interrupted;
    fit.noise_order = std::max(fit.noise_order, of.fit.noise_order);
    fit.widened = std::max(fit.widened, of.fit.widened);
    if (of.fit.whiteness.probability < fit.whiteness.probability) fit.whiteness = of.fit.whiteness;
  }
  fit.residual_rms = pooled(outcomes, [](const fit::Fit& one) {
                       return std::optional(one.residual_rms);
                     }).value_or(0);
  fit.held_out_rms = pooled(outcomes, [](const fit::Fit& one) { return one.held_out_rms; });

  Named named;
  for (const std::string& name : names) {
    fit.parameters.push_back(estimate_of(outcomes, name, named));
  }
  if (!named.disagree.empty()) {
    all.warnings.push_back(fmt::format(
        "the logs disagree on {} by more than their own noise (1 %): what lies between them is in "
        "the intervals",
        named.disagree));
  }
  for (const auto& [log, alone] : named.alone) {
    all.warnings.push_back(
        fmt::format("only {} gives {}: an interval of that log alone", log, alone));
  }
  if (outcomes.size() == 2) {
    all.warnings.emplace_back(
        "two logs tell little of what lies between logs: a third narrows the intervals most");
  }
  for (std::string& note : notes_of(outcomes)) all.warnings.push_back(std::move(note));
  return all;
}

// One log behind the other, where the plot is over time.
FitPlot plot_of_all(const std::vector<FitOutcome>& outcomes) {
  FitPlot all = outcomes.front().plot;
  const bool over_time = all.x_label.starts_with("time");
  for (std::size_t i = 1; i < outcomes.size(); ++i) {
    const FitPlot& next = outcomes[i].plot;
    const double from = over_time && !all.x.empty() ? all.x.back() : 0;
    all.part();
    for (std::size_t k = 0; k < next.x.size(); ++k) {
      all.add(from + next.x[k], next.observed[k], next.residual[k]);
    }
  }
  return all;
}

// A model's parameters are the same in every quarter of a log, if the model is right. Where they
// are not, what lies between the quarters is the interval.
void look_at_quarters(const FitModel& model, const FitRequest& whole, FitOutcome& outcome) {
  constexpr std::size_t kQuarters = 4;
  constexpr std::size_t kLeast = 3;  // that give a parameter
  constexpr std::int64_t kShort = 800;
  fit::Fit& fit = outcome.figures.fit;
  if (fit.interrupted || outcome.figures.samples < kShort) return;
  std::vector<fit::Fit> quarters;
  for (std::size_t part = 0; part < kQuarters; ++part) {
    FitRequest request = whole;
    request.part = part;
    request.parts = kQuarters;
    request.options.hold_out = 0;
    request.options.starts = std::min(request.options.starts, 2);
    try {
      quarters.push_back(model.fit(request).figures.fit);
    } catch (const InputError&) {
      continue;  // nothing moves in it
    }
    if (quarters.back().interrupted) return;
  }
  std::string disagree;
  for (fit::Estimate& e : fit.parameters) {
    std::vector<const fit::Estimate*> given;
    for (const fit::Fit& quarter : quarters) {
      for (const fit::Estimate& q : quarter.parameters) {
        if (q.name == e.name && q.identifiable && !q.fixed && !q.at_bound) given.push_back(&q);
      }
    }
    if (e.fixed || !e.identifiable || given.size() < kLeast) continue;
    const fit::BetweenLogs between = combined(given);
    if (between.probability >= kDisagree) continue;
    e.between = between;
    const double half = std::max(0.5 * (between.high - between.low), 0.5 * (e.high - e.low));
    e.low = std::min(e.low, e.value - half);
    e.high = std::max(e.high, e.value + half);
    add_name(disagree, e.name);
  }
  if (disagree.empty()) return;
  outcome.figures.warnings.insert(
      outcome.figures.warnings.begin(),
      fmt::format("the quarters of this log disagree on {} by more than their own noise (1 %): the "
                  "intervals are as wide as what lies between them",
                  disagree));
}

}  // namespace

FitOutcome fit_logs(const FitModel& model, const std::vector<std::filesystem::path>& logs,
                    const std::function<FitRequest(const std::filesystem::path&)>& request_of) {
  if (logs.size() == 1) {
    const FitRequest request = request_of(logs.front());
    FitOutcome outcome = model.fit(request);
    if (model.parts) look_at_quarters(model, request, outcome);
    if (model.several) {
      outcome.figures.warnings.emplace_back(
          "the intervals are of this log alone: what differs between logs of the same thing is in "
          "those of several, hvp fit A.csv B.csv C.csv");
    }
    return outcome;
  }
  if (!model.several) {
    throw InputError(
        fmt::format("--model {}: expected one log, found {}", model.name, logs.size()));
  }
  require_different(logs);
  std::vector<FitOutcome> outcomes;
  for (const std::filesystem::path& log : logs) {
    outcomes.push_back(model.fit(request_of(log)));
    if (outcomes.back().figures.fit.interrupted) break;
  }
  if (outcomes.size() == 1) return outcomes.front();
  tell_apart(outcomes, logs);
  require_alike(outcomes);
  FitOutcome all;
  all.figures = figures_of_all(outcomes);
  all.settings_of = outcomes.front().settings_of;
  if (all.settings_of) all.settings = all.settings_of(all.figures.fit);
  all.plot = plot_of_all(outcomes);
  return all;
}

}  // namespace hvp::app
