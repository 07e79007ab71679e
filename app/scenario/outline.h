#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "models/config/declaration.h"

namespace hvp::scenario {

// One key of a table.
struct OutlineRow {
  std::string name;
  std::string type;      // "time", "three lengths", "whole number", "one of `a`, `b`" …
  std::string range;     // empty if any value is admitted
  std::string fallback;  // the default as TOML; empty if there is none
  std::string help;
  std::string source;
  bool required = false;
  std::string condition = {};  // "only with `shape` = "sphere""; empty if the key always belongs
};

struct OutlineTable {
  enum class Kind { table, effect, list };
  std::string path;  // "host.jitter"; empty for the root
  Kind kind = Kind::table;
  std::string help;
  std::string source;
  bool required = false;
  std::string condition = {};
  std::string cost = {};                 // of an effect
  std::vector<config::Need> needs = {};  // of an effect
  std::vector<OutlineRow> rows = {};
};

// A part's declaration as data: every table, effect and list in the order of declaration, a table
// before its sub-tables. Effects and lists are shown with one item and their defaults.
using Outline = std::vector<OutlineTable>;

class Describer : public config::Visitor {
 public:
  Describer();
  Outline take() { return std::move(outline_); }

  using config::Visitor::integer;
  void quantity(std::string_view name, double& value, config::Dimension dimension,
                config::Range range, config::Note note) override;
  void vector(std::string_view name, Eigen::Vector3d& value, config::Dimension dimension,
              config::Range range, config::Note note) override;
  void integer(std::string_view name, std::int64_t& value, config::IntegerRange range,
               config::Note note) override;
  void boolean(std::string_view name, bool& value, config::Note note) override;
  void text(std::string_view name, std::string& value, config::Note note) override;
  void file(std::string_view name, config::File& file, config::Note note) override;
  void choice_index(std::string_view name, std::size_t& index,
                    const std::vector<std::string_view>& names, config::Note note) override;

 protected:
  void begin_table(std::string_view name, config::Note note) override;
  void end_table() override;
  bool begin_effect(std::string_view name, bool& present, const config::EffectNote& note) override;
  void end_effect() override;
  bool begin_list(std::string_view name, std::size_t& count, config::Note note) override;
  void begin_item(std::size_t /*index*/) override {}
  void end_item() override {}
  void end_list() override;
  void list_is_effect(std::string_view name, bool present, const config::EffectNote& note) override;
  bool begin_condition(const config::Condition& condition) override;
  void end_condition() override { stack_.back().conditions.pop_back(); }
  bool describes_only() const override { return true; }

 private:
  void add(std::string_view name, std::string type, std::string range, std::string fallback,
           const config::Note& note);
  void open(OutlineTable::Kind kind, std::string_view name, const config::Note& note);
  void close();

  Outline outline_;
  struct Open {
    std::size_t index = 0;                     // in outline_
    std::vector<std::string> conditions = {};  // of the keys being declared
  };
  OutlineTable& table() { return outline_[stack_.back().index]; }
  std::string condition() const;

  std::vector<Open> stack_;
};

template <class Part>
Outline describe(const Part& part) {
  Part copy = part;
  Describer describer;
  describer.visit(copy);
  return describer.take();
}

}  // namespace hvp::scenario
