#include "app/draw/run_files.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/files/csv.h"

namespace hvp::draw {
namespace {

// One line of frames.csv, which knows where it stands.
class Row {
 public:
  Row(std::string where, std::string_view line, const std::vector<std::string>& header)
      : where_(std::move(where)), fields_(files::csv_cells(line)), header_(header) {
    if (fields_.size() != header.size())
      throw InputError(
          fmt::format("{}: {} fields, the header has {}", where_, fields_.size(), header.size()));
  }

  std::string_view text(std::size_t column) const { return fields_[column]; }

  template <class Number>
  Number number(std::size_t column) const {
    const std::string_view field = fields_[column];
    Number value{};
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc() || end != field.data() + field.size())
      throw InputError(
          fmt::format("{}: {} is '{}', expected a number", where_, header_[column], field));
    return value;
  }

 private:
  std::string where_;
  std::vector<std::string_view> fields_;
  const std::vector<std::string>& header_;
};

std::ifstream open(const std::filesystem::path& path) {
  // A pipe in its place would be waited for.
  std::ifstream file;
  if (std::filesystem::is_regular_file(path)) file.open(path, std::ios::binary);
  if (!file.is_open()) throw InputError(path.filename().string() + ": no such file");
  return file;
}

nlohmann::json read_json(const std::filesystem::path& path) {
  std::ifstream file = open(path);
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
  std::ifstream file = open(path);
  const std::string name = path.filename().string();
  const auto next_line = [&file](std::string& line) {
    if (!std::getline(file, line)) return false;
    if (line.ends_with('\r')) line.pop_back();
    return true;
  };

  std::string line;
  next_line(line);
  std::vector<std::string> header;
  for (const std::string_view title : files::csv_cells(line)) header.emplace_back(title);
  const auto column = [&](std::string_view title) {
    const auto found = std::find(header.begin(), header.end(), title);
    if (found == header.end())
      throw InputError(fmt::format("{}:1: has no column '{}'", name, title));
    return static_cast<std::size_t>(found - header.begin());
  };
  const std::size_t frame = column("frame");
  const std::size_t latency = column("latency_us");
  const std::size_t in_time = column("in_time");
  const std::size_t contact = column("contact_node");

  std::vector<FrameRow> rows;
  for (int number = 2; next_line(line); ++number) {
    const Row row(fmt::format("{}:{}", name, number), line, header);
    FrameRow& out = rows.emplace_back();
    out.frame = row.number<long>(frame);
    out.latency_us = row.text(latency).empty() ? std::numeric_limits<double>::quiet_NaN()
                                               : row.number<double>(latency);
    const std::string_view verdict = row.text(in_time);
    if (verdict != "0" && verdict != "1" && verdict != "true" && verdict != "false")
      throw InputError(
          fmt::format("{}:{}: in_time is '{}', expected 0 or 1", name, number, verdict));
    out.in_time = verdict == "1" || verdict == "true";
    out.contact_node = row.number<int>(contact);
  }
  if (rows.empty()) throw InputError(name + ": has no frame");
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
  // What took no time is no phase of the picture, as it is no line on the terminal.
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

}  // namespace hvp::draw
