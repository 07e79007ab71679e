#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/scenario/key_visitor.h"
#include "models/config/declaration.h"

namespace hvp::scenario {

// One key of a table, with its default.
struct OutlineRow {
  std::string name;
  Key key;
  std::string help;
  std::string source;
  bool required = false;
  std::vector<config::Condition> conditions = {};  // under which it belongs to its table
  std::size_t order = 0;                           // of its declaration, among all keys
};

struct OutlineTable {
  enum class Kind { table, effect, list, optional };
  std::string path;  // "host.jitter"; empty for the root
  Kind kind = Kind::table;
  std::size_t parent = 0;  // the index of the table around it; the root's own for the root
  std::string help;
  std::string source;
  bool required = false;
  std::vector<config::Condition> conditions = {};  // under which it belongs to its parent
  bool is_effect = false;                          // a list may be one too
  std::string cost = {};                           // of an effect, as the next two
  std::vector<config::Need> needs = {};
  bool implied = false;
  std::vector<OutlineRow> rows = {};
};

// A part's declaration as data: every table, effect and list in the order of declaration, a table
// before its sub-tables. Effects and lists are shown with one item and their defaults.
using Outline = std::vector<OutlineTable>;

class Describer : public KeyVisitor {
 public:
  Describer();
  Outline take() { return std::move(outline_); }

 protected:
  void key(std::string_view name, const Key& key, const config::Note& note) override;
  void begin_table(std::string_view name, config::Note note) override;
  void end_table() override { stack_.pop_back(); }
  bool begin_effect(std::string_view name, bool& present, const config::EffectNote& note) override;
  void end_effect() override { stack_.pop_back(); }
  bool begin_optional(std::string_view name, bool& present, config::Note note) override;
  bool begin_list(std::string_view name, std::size_t& count, config::Note note) override;
  void begin_item(std::size_t /*index*/) override {}
  void end_item() override {}
  void end_list() override { stack_.pop_back(); }
  void list_is_effect(std::string_view name, bool present, const config::EffectNote& note) override;
  bool begin_condition(const config::Condition& condition) override;
  void end_condition() override { stack_.back().conditions.pop_back(); }
  bool describes_only() const override { return true; }

 private:
  struct Open {
    std::size_t index = 0;                           // in outline_
    std::vector<config::Condition> conditions = {};  // of the keys being declared
  };

  void open(OutlineTable::Kind kind, std::string_view name, const config::Note& note);
  OutlineTable& table() { return outline_[stack_.back().index]; }
  static void note_effect(OutlineTable& table, const config::EffectNote& note);

  Outline outline_;
  std::vector<Open> stack_;
  std::size_t keys_ = 0;
};

template <class Part>
Outline describe(const Part& part) {
  Part copy = part;
  Describer describer;
  describer.visit(copy);
  return describer.take();
}

}  // namespace hvp::scenario
