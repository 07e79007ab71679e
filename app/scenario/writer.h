#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "app/scenario/key_visitor.h"
#include "models/config/declaration.h"

namespace hvp::scenario {

// Writes a declared struct as TOML. TOML requires a table's own keys before its sub-tables; a
// declaration need not follow that order, so text() assembles the tables at the end.
class Writer : public KeyVisitor {
 public:
  Writer();
  using KeyVisitor::text;  // the hook of a key that is a text
  std::string text() const;

 protected:
  void key(std::string_view name, const Key& key, const config::Note&) override;
  void begin_table(std::string_view name, config::Note) override;
  void end_table() override;
  bool begin_effect(std::string_view name, bool& present, const config::EffectNote&) override;
  void end_effect() override;
  bool begin_optional(std::string_view name, bool& present, config::Note note) override;
  void end_optional() override { end_table(); }
  bool begin_list(std::string_view name, std::size_t& count, config::Note) override;
  void begin_item(std::size_t index) override;
  void end_item() override;
  void end_list() override;
  bool begin_condition(const config::Condition& condition) override { return condition.holds(); }

 private:
  struct Table {
    std::string path;
    std::string header;  // "[a.b]", "[[a.b]]" or a comment; empty for the root
    std::string lines;
    std::vector<std::unique_ptr<Table>> children;
  };

  void line(std::string_view name, std::string_view value);
  Table& open(const std::string& path, std::string header);
  static void append(const Table& table, std::string& text);

  Table root_;
  std::vector<Table*> stack_;
  std::vector<std::string> lists_;  // paths of the open lists
};

// The text of scenario.resolved.toml: every parameter that belongs to the chosen kinds with its
// value and unit, and absent effects as comments. Reading it gives an equal struct, and equal
// structs give equal bytes. Paths are those that the scenario names. Throws std::invalid_argument
// if a double is not finite.
template <class Root>
std::string resolved(const Root& root) {
  Root copy = root;  // declare() needs a mutable struct
  Writer writer;
  writer.visit(copy);
  return writer.text();
}

}  // namespace hvp::scenario
