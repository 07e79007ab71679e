#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace hvp::scenario {

// Where a value comes from: a line of a file, or one of the --set overrides.
struct Origin {
  int line = 1;
  int override_index = -1;  // -1: a file
  int file = 0;             // which of the document's: the less, the more it counts

  bool in_file() const { return override_index < 0; }
  // Whether it was laid over the other: an override over files, a scenario over its base.
  bool over(const Origin& other) const {
    return in_file() == other.in_file() ? in_file() && file < other.file : !in_file();
  }
  // The scenario first, in its order, then what lies under it; then the overrides in theirs.
  friend bool operator<(const Origin& a, const Origin& b) {
    return std::tie(a.override_index, a.file, a.line) < std::tie(b.override_index, b.file, b.line);
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

// Lays a table over another: what both have as tables is merged, all else is the upper one's. An
// upper `name = false` takes the lower one's table of that name out.
void lay_over(Node upper, Node& lower);

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
