#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace hvp::scenario {

// The origin of a value: a line of a file, or one of the --set overrides.
struct Origin {
  int line = 1;
  int override_index = -1;  // -1: a file
  int file = 0;             // index in the document's files, the topmost first

  bool in_file() const { return override_index < 0; }
  // True if this origin lies over the other: an override over files, a scenario over its base.
  bool over(const Origin& other) const {
    return in_file() == other.in_file() ? in_file() && file < other.file : !in_file();
  }
  // Orders origins: the scenario by lines, then the files below it, then the overrides.
  friend bool operator<(const Origin& a, const Origin& b) {
    return std::tie(a.override_index, a.file, a.line) < std::tie(b.override_index, b.file, b.line);
  }
};

// A TOML value with its origin. Tables and arrays own their members.
struct Node {
  enum class Kind { table, array, text, integer, number, boolean, date };

  Kind kind = Kind::table;
  Origin origin;
  std::string text;  // of a text or date; in an override also of any other scalar, as it was typed
  std::int64_t integer = 0;
  double number = 0.0;
  bool boolean = false;
  std::vector<std::string> keys;  // of a table: keys[i] names members[i]
  std::vector<Node> members;

  bool is_table() const { return kind == Kind::table; }
  bool is_array() const { return kind == Kind::array; }
  // Returns the table's member, or nullptr if there is none.
  const Node* find(std::string_view key) const;
  Node* find(std::string_view key);
  Node& add(std::string_view key, Node member);
  void remove(std::string_view key);
};

// Lays a table over another. Tables that both have are merged; otherwise the upper value replaces
// the lower one. An upper `name = false` removes the lower table of that name.
void lay_over(Node upper, Node& lower);

// Describes a value for a message that ends in "found …": 2, "abc", a table, a list.
std::string found_text(const Node& node);

// One step of a key such as host.costs[2].time: a name and the indices behind it.
struct KeyStep {
  std::string name;
  std::vector<std::size_t> indices;
};

// Splits a dotted key into steps. Returns an empty list for a malformed key: an empty name, a
// quote, a bracket without a whole number of at most six digits, more than 32 steps.
std::vector<KeyStep> split_key(std::string_view key);

// Puts `value` at `key` of the tree. Throws InputError if the key is malformed, steps into
// something that is neither a table nor a list, or has an index beyond the list's end.
void put(Node& root, const std::string& key, Node value);

}  // namespace hvp::scenario
