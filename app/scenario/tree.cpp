#include "app/scenario/tree.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/scenario/message.h"
#include "app/scenario/toml_text.h"

namespace hvp::scenario {
namespace {

constexpr std::size_t kMostSteps = 32;
constexpr std::size_t kIndexDigits = 6;

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-';
}

// One step, or false.
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

}  // namespace hvp::scenario
