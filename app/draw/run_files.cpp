#include "app/draw/run_files.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/files/csv.h"

namespace hvp::draw {

std::ifstream open_file(const std::filesystem::path& path) {
  // Opening a pipe would wait for its writer.
  std::ifstream file;
  if (std::filesystem::is_regular_file(path)) file.open(path, std::ios::binary);
  if (!file.is_open()) throw InputError(path.filename().string() + ": no such file");
  return file;
}

namespace {

nlohmann::json read_json(const std::filesystem::path& path) {
  std::ifstream file = open_file(path);
  nlohmann::json json = nlohmann::json::parse(file, nullptr, false);
  if (json.is_discarded()) throw InputError(path.filename().string() + ": not well-formed JSON");
  return json;
}

const nlohmann::json& member(const nlohmann::json& object, const char* key,
                             const std::string& where) {
  if (!object.is_object() || !object.contains(key))
    throw InputError(fmt::format("{} has no '{}'", where, key));
  return object.at(key);
}

double duration(const nlohmann::json& object, const char* key, const std::string& where) {
  const nlohmann::json& value = member(object, key, where);
  if (!value.is_number() || !std::isfinite(value.get<double>()) || value.get<double>() < 0.0)
    throw InputError(fmt::format(
        "{}.{} is {}, expected microseconds", where, key,
        value.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace).substr(0, 40)));
  return value.get<double>();
}

std::string words(const nlohmann::json& object, const char* key, const std::string& where) {
  const nlohmann::json& value = member(object, key, where);
  if (!value.is_string()) throw InputError(fmt::format("{}.{} is not a text", where, key));
  return value.get<std::string>();
}

}  // namespace

std::vector<FrameRow> read_frames(const std::filesystem::path& path) {
  std::ifstream file = open_file(path);
  files::CsvTable table(file, path.filename().string());
  const std::size_t frame = table.column("frame");
  const std::size_t latency = table.column("latency_us");
  const std::size_t in_time = table.column("in_time");
  const std::size_t contact = table.column("contact_node");

  std::vector<FrameRow> rows;
  while (table.next()) {
    FrameRow& out = rows.emplace_back();
    out.frame = table.number<long>(frame);
    out.latency_us = table.number_or_nan(latency);
    const std::string_view verdict = table.text(in_time);
    if (verdict != "0" && verdict != "1" && verdict != "true" && verdict != "false")
      throw InputError(fmt::format("{}: in_time is '{}', expected 0 or 1", table.where(), verdict));
    out.in_time = verdict == "1" || verdict == "true";
    out.contact_node = table.number<int>(contact);
  }
  if (rows.empty()) throw InputError(table.name() + ": has no frame");
  return rows;
}

Caption read_caption(const std::filesystem::path& path) {
  const nlohmann::json summary = read_json(path);
  Caption out;
  if (!summary.is_object()) return out;
  const auto text = [](const nlohmann::json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  out.title = text(summary, "title");
  out.verdict = text(summary, "verdict");
  if (const auto held = summary.find("held"); held != summary.end() && held->is_boolean()) {
    out.held = held->get<bool>();
  }
  const auto stability = summary.find("stability");
  if (stability == summary.end() || !stability->is_object()) return out;
  const auto flags = stability->find("flags");
  if (flags == stability->end() || !flags->is_array()) return out;
  for (const nlohmann::json& flag : *flags) {
    if (flag.is_string()) out.flags.push_back(flag.get<std::string>());
  }
  return out;
}

Deadline read_deadline(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  const nlohmann::json summary = read_json(path);

  Deadline out;
  const nlohmann::json& deadline = member(summary, "deadline", name);
  const std::string where = name + ": deadline";
  out.period_us = duration(deadline, "period_us", where);
  out.worst_us = duration(deadline, "worst_us", where);
  out.budget_us =
      deadline.contains("budget_us") ? duration(deadline, "budget_us", where) : out.period_us;

  const nlohmann::json& attribution = member(summary, "attribution", name);
  if (!attribution.is_array()) throw InputError(name + ": attribution is not a list");
  for (std::size_t i = 0; i < attribution.size(); ++i) {
    const std::string entry = fmt::format("{}: attribution[{}]", name, i);
    out.attribution.push_back({words(attribution[i], "part", entry),
                               words(attribution[i], "phase", entry),
                               duration(attribution[i], "us", entry)});
  }
  return out;
}

std::vector<Contribution> largest_contributions(const std::vector<Contribution>& all,
                                                double smallest_share, std::size_t most) {
  std::map<std::pair<std::string, std::string>, double> by_name;
  double sum = 0.0;
  for (const Contribution& one : all) {
    by_name[{one.part, one.phase}] += one.us;
    sum += one.us;
  }
  std::vector<Contribution> rows;
  rows.reserve(by_name.size());
  // A phase that took no time is left out, as on the terminal.
  for (const auto& [name, us] : by_name) {
    if (us > 0) rows.push_back({name.first, name.second, us});
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [](const Contribution& a, const Contribution& b) { return a.us > b.us; });

  std::size_t kept = 0;
  while (kept < rows.size() && rows[kept].us >= smallest_share * sum) ++kept;
  if (kept > most || (kept == most && kept < rows.size())) kept = most - 1;
  // "other" that stands for a single row says less than the row itself.
  if (kept + 1 >= rows.size() && rows.size() <= most) return rows;
  double rest = 0.0;
  for (std::size_t i = kept; i < rows.size(); ++i) rest += rows[i].us;
  const std::size_t count = rows.size() - kept;
  rows.resize(kept);
  rows.push_back({"other", fmt::format("{} phases", count), rest});
  return rows;
}

namespace {

constexpr std::array kAxes = {'x', 'y', 'z'};

// A column of the file and where its values go.
struct Source {
  std::size_t column;
  std::vector<double>* values;
};

void add_sources(std::vector<Source>& sources, const files::CsvTable& table,
                 const std::string& prefix, ProbeSeries& probe) {
  const auto vector = [&](const char* quantity, const char* unit, auto& components) {
    for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
      const std::string name = fmt::format("{}{}_{}_{}", prefix, quantity, kAxes[axis], unit);
      sources.push_back({table.column(name), &components[axis]});
    }
  };
  vector("tip", "m", probe.tip_m);
  vector("intended", "m", probe.intended_m);
  vector("motor", "N", probe.motor_N);
  vector("hand", "N", probe.hand_N);
  sources.push_back({table.column(prefix + "stored_J"), &probe.stored_J});
  sources.push_back({table.column(prefix + "port_J"), &probe.port_J});
  sources.push_back({table.column(prefix + "fed_in"), &probe.fed_in});
}

}  // namespace

std::optional<LoopSeries> read_loop(const std::filesystem::path& path) {
  std::ifstream file = open_file(path);
  files::CsvTable table(file, path.filename().string());
  std::vector<std::string> prefixes;
  // A probe without a device of mass has its contact alone.
  for (std::size_t i = 0;; ++i) {
    const std::string prefix = i == 0 ? "" : fmt::format("probe{}_", i);
    if (table.find(prefix + "tip_x_m")) {
      prefixes.push_back(prefix);
    } else if (!table.find(prefix + "contact_node")) {
      break;
    }
  }
  if (prefixes.empty()) return {};

  LoopSeries out;
  out.probes.resize(prefixes.size());
  std::vector<Source> sources;
  for (std::size_t i = 0; i < prefixes.size(); ++i) {
    add_sources(sources, table, prefixes[i], out.probes[i]);
  }
  const std::size_t born = table.column("born_us");
  while (table.next()) {
    const double time_s = table.number<double>(born) * 1e-6;
    if (!std::isfinite(time_s) || (!out.time_s.empty() && time_s < out.time_s.back()))
      throw InputError(fmt::format("{}: born_us is '{}', expected no less than in the line before",
                                   table.where(), table.text(born)));
    out.time_s.push_back(time_s);
    for (const Source& source : sources) {
      source.values->push_back(table.number_or_nan(source.column));
    }
  }
  if (out.time_s.empty()) throw InputError(table.name() + ": has no frame");
  return out;
}

std::size_t main_axis(const ProbeSeries& probe) {
  std::size_t most = 0;
  double widest = -1.0;
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    const double width =
        std::max(range_of(probe.tip_m[axis]).size(), range_of(probe.intended_m[axis]).size());
    if (width > widest) most = axis;
    widest = std::max(widest, width);
  }
  return most;
}

void Range::include(const Range& other) {
  least = std::min(least, other.least);
  largest = std::max(largest, other.largest);
}

Range range_of(const std::vector<double>& values) {
  std::optional<Range> range;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    if (!range) range = {value, value};
    range->include({value, value});
  }
  return range.value_or(Range{});
}

}  // namespace hvp::draw
