#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "models/config/quiet_visitor.h"

namespace hvp::config {

// "a", "a or b", "a, b or c".
std::string alternatives(const std::vector<std::string>& items);

struct Effect {
  std::string path;      // "bus.pcie"
  bool present = false;  // in what was visited
  std::string help;
  std::string cost;
  std::vector<Need> needs;
  // KEY=VALUE, as --set takes it, beside which alone it may be there; empty: beside any.
  std::string belongs_to = {};
};

// All effects that a declaration has, those of absent effects included, and the values of the
// choices and whole numbers that they may need.
class EffectSurvey : public QuietVisitor {
 public:
  using QuietVisitor::integer;
  void integer(std::string_view name, std::int64_t& value, IntegerRange, Note) override;
  void choice_index(std::string_view name, std::size_t& index,
                    const std::vector<std::string_view>& names, Note) override;

  // In the order of their declaration.
  const std::vector<Effect>& effects() const& { return effects_; }
  std::vector<Effect> effects() && { return std::move(effects_); }
  // What has to be set, KEY=VALUE as --set takes it, before an effect that is absent can be there:
  // by its own needs and by those of the effects that it needs or stands in. Empty where nothing
  // has to be. Whether the scenario takes all of it is for the scenario to say.
  std::vector<std::string> to_bring(const Effect& effect) const;
  // Throws InputError, its key the effect, for the first effect that is present and needs what is
  // not there; std::logic_error for a need of a key that is not declared.
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
    // Another value of the same key as a scenario writes it.
    std::string shown(std::string_view other) const;
  };

  // Where the visit is: inside something absent, neither values nor effects are the scenario's.
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
  std::map<std::string, std::string> left_out_;  // keys, and why
};

template <class Root>
EffectSurvey survey_effects(const Root& root) {
  Root copy = root;  // declare() takes what it may also fill
  EffectSurvey survey;
  survey.visit(copy);
  return survey;
}

}  // namespace hvp::config
