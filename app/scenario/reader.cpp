#include "app/scenario/reader.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "app/scenario/message.h"
#include "app/scenario/quantity.h"
#include "app/scenario/toml_text.h"

namespace hvp::scenario {
namespace {

using config::Dimension;
using config::Note;

bool is_number(const Node& node) {
  return node.kind == Node::Kind::integer || node.kind == Node::Kind::number;
}

double number_of(const Node& node) {
  return node.kind == Node::Kind::integer ? static_cast<double>(node.integer) : node.number;
}

std::string quantity_example(Dimension dimension) {
  if (dimension == Dimension::dimensionless) return "a number such as 0.5";
  return fmt::format("{} such as \"{}\"", dimension_name(dimension), dimension_example(dimension));
}

// Returns "; did you mean …?", or a list of the valid names.
std::string suggestion(const std::string& unknown, const std::string& in_table,
                       const std::vector<std::string>& declared, const Outline& outline) {
  const std::vector<std::string_view> names(declared.begin(), declared.end());
  std::vector<std::string> meant;
  const std::string_view close = nearest(unknown, names);
  if (!close.empty()) meant.push_back(fmt::format("\"{}\"", close));
  // The same name in another table: the key is valid, but in the wrong place.
  for (const OutlineTable& table : outline) {
    if (meant.size() > 2) break;
    const std::string last = table.path.substr(table.path.rfind('.') + 1);
    if (last == unknown) meant.push_back(fmt::format("\"{}\"", table.path));
    if (table.path == in_table) continue;
    for (const OutlineRow& row : table.rows) {
      if (row.name == unknown) meant.push_back(fmt::format("\"{}\"", joined(table.path, unknown)));
    }
  }
  if (!meant.empty()) return fmt::format("; did you mean {}?", alternatives(meant));
  if (names.empty()) return "";
  return fmt::format("; {} has {}", in_table.empty() ? "the scenario" : "[" + in_table + "]",
                     fmt::join(names, ", "));
}

}  // namespace

Reader::Reader(const Document& document) : document_(document) {
  levels_.push_back({&document.root(), "", "", document.root().origin});
}

std::string Reader::key_of(std::string_view name) const {
  return joined(levels_.back().path, key_text(name));
}

bool Reader::precedes_first(Stage stage, const Origin& origin) const {
  if (!first_) return true;
  return stage != first_->stage ? stage < first_->stage : origin < first_->origin;
}

void Reader::wrong(const Node& node, std::string key, std::string message) {
  if (!precedes_first(Stage::wrong, node.origin)) return;
  first_ = Error{Stage::wrong, node.origin, std::move(key), std::move(message)};
}

const Node* Reader::find(std::string_view name) const {
  const Node* table = levels_.back().node;
  return table == nullptr ? nullptr : table->find(name);
}

bool Reader::begin_condition(const config::Condition& condition) {
  levels_.back().conditions.push_back(condition);
  return true;
}

const config::Condition* Reader::unmet_condition() const {
  const auto& conditions = levels_.back().conditions;
  const auto unmet = std::find_if(conditions.begin(), conditions.end(),
                                  [](const auto& condition) { return !condition.holds(); });
  return unmet == conditions.end() ? nullptr : &*unmet;
}

// Returns the scenario's value of a name, or nullptr.
const Node* Reader::take(std::string_view name, const Note& note) {
  Level& level = levels_.back();
  level.declared.emplace_back(name);
  const Node* node = find(name);
  if (const config::Condition* unmet = unmet_condition()) {
    // An override, or a scenario over its base, that chooses another kind also drops the values
    // below it that belong to the old kind.
    if (!unmet->why_not_beside.empty()) {
      if (node != nullptr) {
        wrong(*node, key_of(name),
              fmt::format("not beside [{}]: {}", unmet->key, unmet->why_not_beside));
      }
      return nullptr;
    }
    const Node* decides = find(unmet->key);
    const bool left_behind =
        node != nullptr && decides != nullptr && decides->origin.over(node->origin);
    if (node != nullptr && !level.uncertain && !left_behind) {
      wrong(*node, key_of(name),
            fmt::format("belongs to {} = {} only, found {}", unmet->key,
                        alternatives(unmet->values), unmet->found));
    }
    return nullptr;
  }
  const bool missing = node == nullptr && note.required && !level.given;
  if (missing && precedes_first(Stage::missing, level.origin)) {
    first_ = Error{Stage::missing, level.origin, key_of(name),
                   fmt::format("missing required key: {}", note.help)};
  }
  return node;
}

bool Reader::read_quantity(const Node& node, const std::string& key, double& value,
                           Dimension dimension, const config::Range& range, std::string_view word) {
  double result = 0.0;
  if (dimension == Dimension::dimensionless) {
    if (!is_number(node)) {
      wrong(node, key, fmt::format("expected a number such as 0.5, found {}", found_text(node)));
      return false;
    }
    result = number_of(node);
    if (!std::isfinite(result)) {
      wrong(node, key, fmt::format("expected a finite number, found {}", found_text(node)));
      return false;
    }
  } else if (node.kind == Node::Kind::text) {
    try {
      result = parse_quantity(node.text, dimension);
    } catch (const InputError& error) {
      std::string expected = error.what();
      constexpr std::string_view kExpected = "expected ";
      if (!word.empty() && expected.starts_with(kExpected)) {
        expected.insert(kExpected.size(), fmt::format("\"{}\" or ", word));
      }
      wrong(node, key, expected);
      return false;
    }
  } else {
    wrong(node, key,
          is_number(node) ? missing_unit(dimension, found_text(node))
                          : fmt::format("expected {}, found {}", quantity_example(dimension),
                                        found_text(node)));
    return false;
  }
  if (!contains(range, result)) {
    const std::string found =
        node.kind == Node::Kind::text ? one_line(node.text, 60) : found_text(node);
    wrong(node, key,
          fmt::format("out of range: expected {}, found {}", range_text(range, dimension), found));
    return false;
  }
  value = result;
  return true;
}

void Reader::quantity(std::string_view name, double& value, Dimension dimension,
                      config::Range range, Note note) {
  const Node* node = take(name, note);
  if (node == nullptr) return;
  if (!note.word.empty() && node->kind == Node::Kind::text && node->text == note.word) {
    value = 0;
    return;
  }
  read_quantity(*node, key_of(name), value, dimension, range, note.word);
}

void Reader::vector(std::string_view name, Eigen::Vector3d& value, Dimension dimension,
                    config::Range range, Note note) {
  const Node* node = take(name, note);
  if (node == nullptr) return;
  if (!node->is_array() || node->members.size() != 3) {
    wrong(*node, key_of(name),
          fmt::format("expected a list of three components, each {}, found {}",
                      quantity_example(dimension), found_text(*node)));
    return;
  }
  Eigen::Vector3d result = value;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string key = fmt::format("{}[{}]", key_of(name), i);
    if (!read_quantity(node->members[i], key, result[static_cast<Eigen::Index>(i)], dimension,
                       range)) {
      return;
    }
  }
  value = result;
}

void Reader::integer(std::string_view name, std::int64_t& value, config::IntegerRange range,
                     Note note) {
  const Node* node = take(name, note);
  if (node == nullptr) return;
  if (node->kind != Node::Kind::integer) {
    wrong(*node, key_of(name), fmt::format("expected a whole number, found {}", found_text(*node)));
    return;
  }
  if (node->integer < range.min || node->integer > range.max) {
    std::string bounds = range_text(range);
    if (bounds.empty()) bounds = fmt::format("from {} to {}", range.min, range.max);
    wrong(*node, key_of(name),
          fmt::format("out of range: expected {}, found {}", bounds, node->integer));
    return;
  }
  value = node->integer;
}

void Reader::boolean(std::string_view name, bool& value, Note note) {
  const Node* node = take(name, note);
  if (node == nullptr) return;
  if (node->kind != Node::Kind::boolean) {
    levels_.back().uncertain = true;
    wrong(*node, key_of(name), fmt::format("expected true or false, found {}", found_text(*node)));
    return;
  }
  value = node->boolean;
}

bool Reader::read_text(const Node& node, const std::string& key, std::string_view expected,
                       std::string& value) {
  // An override such as 2024 may be meant as a text, so it is taken as it was typed.
  const bool typed =
      !node.origin.in_file() && !node.text.empty() && !node.is_table() && !node.is_array();
  if (node.kind != Node::Kind::text && !typed) {
    wrong(node, key, fmt::format("expected {}, found {}", expected, found_text(node)));
    return false;
  }
  value = node.text;
  return true;
}

void Reader::text(std::string_view name, std::string& value, Note note) {
  if (const Node* node = take(name, note)) {
    read_text(*node, key_of(name), "a text in quotes", value);
  }
}

void Reader::file(std::string_view name, config::File& file, Note note) {
  const Node* node = take(name, note);
  if (node == nullptr) return;
  std::string found;
  if (!read_text(*node, key_of(name), "a file name in quotes", found)) return;
  if (found.find('\0') != std::string::npos || (found.empty() && note.required)) {
    wrong(*node, key_of(name), fmt::format("expected a file name, found {}", in_quotes(found)));
    return;
  }
  file = config::File(found);
}

void Reader::choice_index(std::string_view name, std::size_t& index,
                          const std::vector<std::string_view>& names, Note note) {
  const Node* node = take(name, note);
  if (node == nullptr) return;
  std::vector<std::string> items;
  items.reserve(names.size());
  for (const std::string_view item : names) items.push_back(fmt::format("\"{}\"", item));
  const std::string expected = alternatives(items);
  std::string found;
  if (!read_text(*node, key_of(name), expected, found)) {
    levels_.back().uncertain = true;
    return;
  }
  const auto at = std::find(names.begin(), names.end(), found);
  if (at != names.end()) {
    index = static_cast<std::size_t>(at - names.begin());
    return;
  }
  levels_.back().uncertain = true;
  std::string message = fmt::format("expected {}, found {}", expected, in_quotes(found));
  const std::string_view close = nearest(found, names);
  if (!close.empty()) message += fmt::format("; did you mean \"{}\"?", close);
  wrong(*node, key_of(name), message);
}

void Reader::enter(Level level) { levels_.push_back(std::move(level)); }

void Reader::leave() {
  reject_unknown_keys(levels_.back());
  levels_.pop_back();
}

void Reader::begin_table(std::string_view name, Note note) {
  const Node* node = take(name, note);
  const Level& parent = levels_.back();
  if (node != nullptr && !node->is_table()) {
    wrong(*node, key_of(name),
          fmt::format("expected a table [{}], found {}", joined(parent.generic, name),
                      found_text(*node)));
    node = nullptr;
  }
  enter({node, key_of(name), joined(parent.generic, name),
         node == nullptr ? parent.origin : node->origin, parent.uncertain,
         parent.given || unmet_condition() != nullptr,
         parent.left_out || unmet_condition() != nullptr});
}

bool Reader::begin_effect(std::string_view name, bool& present, const config::EffectNote& note) {
  const Node* node = find(name);
  const bool switched =
      node != nullptr && node->kind == Node::Kind::boolean && !node->origin.in_file();
  if (switched && !node->boolean) {
    levels_.back().declared.emplace_back(name);
    present = false;
    return false;
  }
  node = take(name, {.help = note.help});
  const Level& parent = levels_.back();
  present = node != nullptr;
  if (node == nullptr) return false;
  if (!switched && !node->is_table()) {
    wrong(*node, key_of(name),
          fmt::format("expected a table [{}], found {}", joined(parent.generic, name),
                      found_text(*node)));
    present = false;
    return false;
  }
  enter({switched ? nullptr : node, key_of(name), joined(parent.generic, name), node->origin,
         parent.uncertain, parent.given});
  return true;
}

bool Reader::is_list(std::string_view name, std::size_t count) {
  const Node* node = find(name);
  return node == nullptr ? count > 1 : node->is_array();
}

bool Reader::begin_list(std::string_view name, std::size_t& count, Note note) {
  const Node* node = take(name, note);
  if (node != nullptr && !node->is_array()) {
    std::string message = fmt::format("expected a list of tables [[{}]], found {}",
                                      joined(levels_.back().generic, name), found_text(*node));
    if (!node->origin.in_file()) {
      message += fmt::format("; --set writes an item of it as {}[0]", key_of(name));
    }
    wrong(*node, key_of(name), message);
    node = nullptr;
  }
  lists_.push_back({node, key_of(name), joined(levels_.back().generic, name)});
  if (node == nullptr) return false;
  count = node->members.size();
  return true;
}

void Reader::begin_item(std::size_t index) {
  const List& list = lists_.back();
  const Level& parent = levels_.back();
  const Node* node = list.node == nullptr ? nullptr : &list.node->members[index];
  const std::string path = fmt::format("{}[{}]", list.path, index);
  if (node != nullptr && !node->is_table()) {
    wrong(*node, path, fmt::format("expected a table, found {}", found_text(*node)));
    node = nullptr;
  }
  enter({node, path, list.generic, node == nullptr ? parent.origin : node->origin, parent.uncertain,
         parent.given || list.node == nullptr});
}

void Reader::check(const std::function<void()>& rule) {
  reject_unknown_keys(levels_.back());
  if (first_ || levels_.back().left_out) return;
  try {
    rule();
  } catch (const InputError& error) {
    const std::string key = joined(levels_.back().path, error.key());
    first_ = Error{Stage::refused, {}, key, one_line(error.what(), 2000)};
  }
}

void Reader::reject_unknown_keys(const Level& level) {
  if (level.node == nullptr || level.uncertain) return;
  for (std::size_t i = 0; i < level.node->keys.size(); ++i) {
    const std::string& name = level.node->keys[i];
    const Origin& origin = level.node->members[i].origin;
    const auto& declared = level.declared;
    if (std::find(declared.begin(), declared.end(), name) != declared.end()) continue;
    if (!precedes_first(Stage::wrong, origin)) continue;
    first_ = Error{Stage::wrong, origin, joined(level.path, key_text(name)), "unknown key",
                   Unknown{name, level.generic, declared}};
  }
}

void Reader::finish(const std::function<Outline()>& outline) {
  reject_unknown_keys(levels_.back());
  if (!first_) return;
  const std::string place = first_->stage == Stage::refused
                                ? document_.locate(first_->key)
                                : document_.locate(first_->origin, first_->key);
  if (first_->unknown)
    first_->message += suggestion(first_->unknown->name, first_->unknown->table,
                                  first_->unknown->declared, outline());
  throw SourceError(first_->key, place + first_->message);
}

}  // namespace hvp::scenario
