#include "app/scenario/override.h"

#include <utility>

#include <fmt/format.h>

#include "app/scenario/message.h"
#include "app/scenario/syntax.h"
#include "models/config/input_error.h"

namespace hvp::scenario {
namespace {

void set_origin(Node& node, int override_index) {
  node.origin = Origin{.override_index = override_index};
  for (Node& member : node.members) set_origin(member, override_index);
}

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
  // `effect=true` and then a key of it.
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

Node override_value(std::string_view text, int override_index) {
  Node value;
  bool is_toml = false;
  // A line break would let a value define further keys.
  if (text.find_first_of("\r\n") == std::string_view::npos) {
    try {
      Node table = parse_toml("value = " + std::string(text));
      value = std::move(table.members.front());
      is_toml = true;
    } catch (const SyntaxError& error) {
      const char first = text.empty() ? ' ' : text.front();
      if (first == '[' || first == '{' || first == '"' || first == '\'') {
        throw InputError("TOML syntax: " + one_line(error.message));
      }
    }
  }
  if (!is_toml) value.kind = Node::Kind::text;
  if (value.kind != Node::Kind::text || !is_toml) value.text = text;
  set_origin(value, override_index);
  return value;
}

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
  // `effect=true` keeps what the scenario says about an effect that is there already.
  const bool is_true = value.kind == Node::Kind::boolean && value.boolean;
  if (is_true && place->is_table() && !place->keys.empty()) return;
  *place = std::move(value);
}

}  // namespace hvp::scenario
