#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "models/config/declaration.h"

// The conditions of effects on other parts, in a scenario's keys; the survey of a scenario's
// effects.
namespace hvp::config {

inline Need need_timed_bus(std::string_view why) {
  return {"fidelity.bus", {"loosely-timed", "approximately-timed"}, why};
}

inline Need need_bus_cycles() { return {"fidelity.bus", {"approximately-timed"}}; }

inline Need need_timed_host() {
  return {"fidelity.host", {"loosely-timed"}, "the host takes no time"};
}

inline Need need_board(std::string_view why = "there is no board") {
  return {"host.solver", {"board"}, why};
}

inline Need need_numbers() { return {"fidelity.numbers", {"fixed"}, "nobody computes numbers"}; }

// A visitor that does nothing, as a base for one that needs a few things only: it enters tables,
// but neither effects nor lists.
class QuietVisitor : public Visitor {
 public:
  using Visitor::integer;
  void quantity(std::string_view, double&, Dimension, Range, Note) override {}
  void vector(std::string_view, Eigen::Vector3d&, Dimension, Range, Note) override {}
  void integer(std::string_view, std::int64_t&, IntegerRange, Note) override {}
  void boolean(std::string_view, bool&, Note) override {}
  void text(std::string_view, std::string&, Note) override {}
  void file(std::string_view, File&, Note) override {}
  void choice_index(std::string_view, std::size_t&, const std::vector<std::string_view>&,
                    Note) override {}

 protected:
  void begin_table(std::string_view, Note) override {}
  void end_table() override {}
  bool begin_effect(std::string_view, bool&, const EffectNote&) override { return false; }
  void end_effect() override {}
  bool begin_list(std::string_view, std::size_t&, Note) override { return false; }
  void begin_item(std::size_t) override {}
  void end_item() override {}
  void end_list() override {}
};

// Joins items for a message: "a", "a or b", "a, b or c".
std::string alternatives(const std::vector<std::string>& items);

struct Effect {
  std::string path;      // "bus.pcie"
  bool present = false;  // in the visited settings
  std::string help;
  std::string cost;
  std::vector<Need> needs;
  // The setting, KEY=VALUE as for --set, without which the effect may not be present; empty: there
  // is none.
  std::string belongs_to = {};
};

// Collects all effects of a declaration, absent ones included, and the values of the choices and
// whole numbers that they may need.
class EffectSurvey : public QuietVisitor {
 public:
  using QuietVisitor::integer;
  void integer(std::string_view name, std::int64_t& value, IntegerRange, Note) override;
  void choice_index(std::string_view name, std::size_t& index,
                    const std::vector<std::string_view>& names, Note) override;

  // The effects in the order of their declaration.
  const std::vector<Effect>& effects() const& { return effects_; }
  std::vector<Effect> effects() && { return std::move(effects_); }
  // The settings, KEY=VALUE as for --set, that are necessary before an absent effect can be
  // present: for its own needs and for those of the effects that it needs or is part of. Empty
  // where none is necessary. Whether the scenario accepts all of them is checked by the scenario.
  std::vector<std::string> to_bring(const Effect& effect) const;
  // Throws InputError, with the effect as its key, for the first present effect whose need is not
  // met; std::logic_error for a need of a key that is not declared.
  void require_needs() const;

 protected:
  void begin_table(std::string_view name, Note) override;
  void end_table() override;
  bool begin_effect(std::string_view name, bool& present, const EffectNote& note) override;
  void end_effect() override;
  bool begin_list(std::string_view name, std::size_t&, Note) override;
  void end_list() override;
  void list_is_effect(std::string_view name, bool present, const EffectNote& note) override;
  bool begin_condition(const Condition& condition) override;
  void end_condition() override;
  bool describes_only() const override { return true; }

 private:
  struct Value {
    std::string text;
    bool quoted = false;
    // Another value of the same key as in a scenario.
    std::string shown(std::string_view other) const;
  };

  // The place of the visit. Inside something absent, neither values nor effects are the scenario's.
  struct Level {
    std::string path;
    bool there = true;
    std::string why_not = {};
    std::string belongs_to = {};
  };
  std::string path_of(std::string_view name) const;
  bool add(std::string_view name, bool present, const EffectNote& note);
  void enter(std::string_view name, bool there);
  const Effect* find(std::string_view path) const;
  void bring(const Effect& effect, std::vector<std::string>& settings) const;
  void note(std::string_view name, Value value);

  std::vector<Level> levels_ = {{}};
  std::vector<Effect> effects_;
  std::map<std::string, Value> values_;
  std::map<std::string, std::string> left_out_;  // keys, and the reasons
};

template <class Root>
EffectSurvey survey_effects(const Root& root) {
  Root copy = root;  // declare() takes a reference that is not const
  EffectSurvey survey;
  survey.visit(copy);
  return survey;
}

}  // namespace hvp::config
