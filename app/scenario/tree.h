#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hvp::scenario {

// Where a value comes from: a line of the file, or one of the --set overrides.
struct Origin {
  int line = 1;
  int override_index = -1;  // -1: the file

  bool in_file() const { return override_index < 0; }
  // File first, in its order; then the overrides in theirs.
  friend bool operator<(const Origin& a, const Origin& b) {
    return a.override_index != b.override_index ? a.override_index < b.override_index
                                                : a.line < b.line;
  }
};

// A TOML value with its origin. Tables and arrays own their members.
struct Node {
  enum class Kind { table, array, text, integer, number, boolean, date };

  Kind kind = Kind::table;
  Origin origin;
  std::string text;  // of a text or date; of any other scalar in an override, as it was typed
  std::int64_t integer = 0;
  double number = 0.0;
  bool boolean = false;
  std::vector<std::string> keys;  // of a table: keys[i] names members[i]
  std::vector<Node> members;

  bool is_table() const { return kind == Kind::table; }
  bool is_array() const { return kind == Kind::array; }
  // The member of a table, or nullptr.
  const Node* find(std::string_view key) const;
  Node* find(std::string_view key);
  Node& add(std::string_view key, Node member);
  void remove(std::string_view key);
};

// For "found …": 2, "abc", a table, a list.
std::string found_text(const Node& node);

// One step of a key such as host.costs[2].time: a name and the indices behind it.
struct KeyStep {
  std::string name;
  std::vector<std::size_t> indices;
};

// Splits a dotted key. Empty where it is not one (an empty name, a quote, a bracket without a
// whole number of at most six digits, more than 32 steps).
std::vector<KeyStep> split_key(std::string_view key);

}  // namespace hvp::scenario
