#include "app/scenario/tree.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/scenario/message.h"
#include "app/scenario/toml_text.h"
#include "models/config/input_error.h"

namespace hvp::scenario {
namespace {

constexpr std::size_t kMostSteps = 32;
constexpr std::size_t kIndexDigits = 6;

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-';
}

// Parses one step; false if it is malformed.
bool read_step(std::string_view text, KeyStep& step) {
  const auto bracket = std::min(text.find('['), text.size());
  step.name = text.substr(0, bracket);
  if (step.name.empty() || !std::all_of(step.name.begin(), step.name.end(), is_name_character)) {
    return false;
  }
  text.remove_prefix(bracket);
  while (!text.empty()) {
    const auto close = text.find(']');
    if (text[0] != '[' || close == std::string_view::npos) return false;
    const std::string_view digits = text.substr(1, close - 1);
    if (digits.empty() || digits.size() > kIndexDigits) return false;
    std::size_t index = 0;
    for (const char c : digits) {
      if (c < '0' || c > '9') return false;
      index = 10 * index + static_cast<std::size_t>(c - '0');
    }
    step.indices.push_back(index);
    if (step.indices.size() > kMostSteps) return false;
    text.remove_prefix(close + 1);
  }
  return true;
}

}  // namespace

const Node* Node::find(std::string_view key) const {
  const auto at = std::find(keys.begin(), keys.end(), key);
  return at == keys.end() ? nullptr : &members[static_cast<std::size_t>(at - keys.begin())];
}

Node* Node::find(std::string_view key) {
  const auto at = std::find(keys.begin(), keys.end(), key);
  return at == keys.end() ? nullptr : &members[static_cast<std::size_t>(at - keys.begin())];
}

Node& Node::add(std::string_view key, Node member) {
  keys.emplace_back(key);
  members.push_back(std::move(member));
  return members.back();
}

void Node::remove(std::string_view key) {
  const auto at = std::find(keys.begin(), keys.end(), key);
  if (at == keys.end()) return;
  members.erase(members.begin() + (at - keys.begin()));
  keys.erase(at);
}

void lay_over(Node upper, Node& lower) {
  lower.origin = upper.origin;
  for (std::size_t i = 0; i < upper.keys.size(); ++i) {
    Node& member = upper.members[i];
    Node* under = lower.find(upper.keys[i]);
    if (under == nullptr) {
      lower.add(upper.keys[i], std::move(member));
    } else if (under->is_table() && member.is_table()) {
      lay_over(std::move(member), *under);
    } else if (under->is_table() && member.kind == Node::Kind::boolean && !member.boolean) {
      lower.remove(upper.keys[i]);
    } else if (under->is_table() && member.kind == Node::Kind::boolean &&
               !member.origin.in_file()) {
      // `effect=true` keeps the keys of an effect that a base or a model has already.
    } else {
      *under = std::move(member);
    }
  }
}

std::string found_text(const Node& node) {
  switch (node.kind) {
    case Node::Kind::table:
      return "a table";
    case Node::Kind::array:
      return fmt::format("a list of {}", node.members.size());
    case Node::Kind::text:
      return in_quotes(node.text);
    case Node::Kind::integer:
      return std::to_string(node.integer);
    case Node::Kind::number:
      if (node.number != node.number) return "nan";
      if (node.number - node.number != 0.0) return node.number < 0.0 ? "-inf" : "inf";
      return toml_quantity(node.number, config::Dimension::dimensionless);
    case Node::Kind::boolean:
      return node.boolean ? "true" : "false";
    case Node::Kind::date:
      return "a date or time";
  }
  return {};
}

std::vector<KeyStep> split_key(std::string_view key) {
  std::vector<KeyStep> steps;
  while (steps.size() < kMostSteps) {
    const auto dot = key.find('.');
    KeyStep step;
    if (!read_step(key.substr(0, dot), step)) return {};
    steps.push_back(std::move(step));
    if (dot == std::string_view::npos) return steps;
    key.remove_prefix(dot + 1);
  }
  return {};
}

namespace {

Node empty_node(Node::Kind kind, const Origin& origin) {
  Node node;
  node.kind = kind;
  node.origin = origin;
  return node;
}

Node& step_to_name(Node& table, const std::string& name, const std::string& path,
                   const Origin& origin, Node::Kind kind) {
  if (table.is_array()) {
    throw InputError(fmt::format("{} is {}: expected an item of it, which is written {}[0]", path,
                                 found_text(table), path));
  }
  // The key belongs to an effect that an earlier `effect=true` has added.
  if (table.kind == Node::Kind::boolean && table.boolean && !table.origin.in_file()) {
    table = empty_node(Node::Kind::table, table.origin);
  }
  if (!table.is_table()) {
    throw InputError(fmt::format("{} is {}: expected a table", path, found_text(table)));
  }
  if (Node* member = table.find(name)) return *member;
  return table.add(name, empty_node(kind, origin));
}

Node& step_to_item(Node& list, std::size_t index, const std::string& path, const Origin& origin,
                   Node::Kind kind) {
  if (!list.is_array()) {
    throw InputError(fmt::format("{} is {}, not a list", path, found_text(list)));
  }
  const std::size_t count = list.members.size();
  if (index > count) {
    throw InputError(fmt::format("index {} is beyond {}, which has {} in the scenario; {} appends",
                                 index, path,
                                 count == 1 ? "1 item" : fmt::format("{} items", count), count));
  }
  if (index == count) list.members.push_back(empty_node(kind, origin));
  return list.members[index];
}

}  // namespace

void put(Node& root, const std::string& key, Node value) {
  const std::vector<KeyStep> steps = split_key(key);
  if (steps.empty()) {
    throw InputError("expected KEY=VALUE with a key such as object.mesh.nodes or fault[0].frame");
  }
  const Origin origin = value.origin;
  Node* place = &root;
  std::string path;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const KeyStep& step = steps[i];
    const auto kind = step.indices.empty() ? Node::Kind::table : Node::Kind::array;
    place = &step_to_name(*place, step.name, path, origin, kind);
    path = joined(path, step.name);
    for (std::size_t k = 0; k < step.indices.size(); ++k) {
      const bool last = k + 1 == step.indices.size();
      place = &step_to_item(*place, step.indices[k], path, origin,
                            last ? Node::Kind::table : Node::Kind::array);
      path += fmt::format("[{}]", step.indices[k]);
    }
  }
  // `effect=true` keeps the keys of an effect that the scenario has already.
  const bool is_true = value.kind == Node::Kind::boolean && value.boolean;
  if (is_true && place->is_table() && !place->keys.empty()) return;
  *place = std::move(value);
}

}  // namespace hvp::scenario
