#include "app/scenario/outline.h"

#include <utility>

#include <fmt/format.h>

#include "app/scenario/message.h"
#include "app/scenario/quantity.h"
#include "app/scenario/toml_text.h"

namespace hvp::scenario {
namespace {

using config::Dimension;
using config::Note;

// The name of a dimension without its article: "time".
std::string bare_name(Dimension dimension) {
  const std::string_view name = dimension_name(dimension);
  return std::string(name.substr(name.find(' ') + 1));
}

}  // namespace

Describer::Describer() : outline_(1), stack_(1) {}

void Describer::add(std::string_view name, std::string type, std::string range,
                    std::string fallback, const Note& note) {
  OutlineRow row{std::string(name),      std::move(type),
                 std::move(range),       note.required ? "" : std::move(fallback),
                 std::string(note.help), std::string(note.source),
                 note.required,          condition()};
  table().rows.push_back(std::move(row));
}

void Describer::open(OutlineTable::Kind kind, std::string_view name, const Note& note) {
  OutlineTable opened{joined(table().path, name), kind,          std::string(note.help),
                      std::string(note.source),   note.required, condition()};
  stack_.push_back({outline_.size()});
  outline_.push_back(std::move(opened));
}

std::string Describer::condition() const {
  return fmt::format("{}", fmt::join(stack_.back().conditions, ", "));
}

bool Describer::begin_condition(const config::Condition& condition) {
  stack_.back().conditions.push_back(
      condition.why_not_beside.empty()
          ? fmt::format("only with `{}` = {}", condition.key, alternatives(condition.values))
          : fmt::format("not beside `[{}]`", condition.key));
  return true;
}

void Describer::close() { stack_.pop_back(); }

void Describer::quantity(std::string_view name, double& value, Dimension dimension,
                         config::Range range, Note note) {
  add(name, bare_name(dimension), range_text(range, dimension),
      note.required ? "" : toml_quantity(value, dimension), note);
}

void Describer::vector(std::string_view name, Eigen::Vector3d& value, Dimension dimension,
                       config::Range range, Note note) {
  add(name, "three components, each a " + bare_name(dimension), range_text(range, dimension),
      note.required ? "" : toml_vector(value, dimension), note);
}

void Describer::integer(std::string_view name, std::int64_t& value, config::IntegerRange range,
                        Note note) {
  add(name, "whole number", range_text(range), std::to_string(value), note);
}

void Describer::boolean(std::string_view name, bool& value, Note note) {
  add(name, "true or false", "", value ? "true" : "false", note);
}

void Describer::text(std::string_view name, std::string& value, Note note) {
  add(name, "text", "", toml_string(value), note);
}

void Describer::file(std::string_view name, config::File& file, Note note) {
  add(name, "file", "", file.empty() ? "" : toml_string(file.written), note);
}

void Describer::choice_index(std::string_view name, std::size_t& index,
                             const std::vector<std::string_view>& names, Note note) {
  std::vector<std::string> items;
  items.reserve(names.size());
  for (const std::string_view item : names) items.push_back(toml_string(item));
  add(name, "one of", alternatives(items), toml_string(names.at(index)), note);
}

void Describer::begin_table(std::string_view name, Note note) {
  open(OutlineTable::Kind::table, name, note);
}

void Describer::end_table() { close(); }

bool Describer::begin_effect(std::string_view name, bool& /*present*/,
                             const config::EffectNote& note) {
  open(OutlineTable::Kind::effect, name, {.help = note.help});
  table().cost = note.cost;
  table().needs = note.needs;
  return true;
}

void Describer::list_is_effect(std::string_view name, bool /*present*/,
                               const config::EffectNote& note) {
  const std::string path = joined(table().path, name);
  for (OutlineTable& listed : outline_) {
    if (listed.path != path) continue;
    listed.cost = note.cost;
    listed.needs = note.needs;
  }
}

void Describer::end_effect() { close(); }

bool Describer::begin_list(std::string_view name, std::size_t& /*count*/, Note note) {
  open(OutlineTable::Kind::list, name, note);
  return false;
}

void Describer::end_list() { close(); }

}  // namespace hvp::scenario
