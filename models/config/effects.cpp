#include "models/config/effects.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "models/config/input_error.h"

namespace hvp::config {

std::string alternatives(const std::vector<std::string>& items) {
  std::string result;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) result += i + 1 == items.size() ? " or " : ", ";
    result += items[i];
  }
  return result;
}

std::string EffectSurvey::Value::shown(std::string_view other) const {
  return quoted ? '"' + std::string(other) + '"' : std::string(other);
}

std::string EffectSurvey::path_of(std::string_view name) const {
  const std::string& table = levels_.back().path;
  return table.empty() ? std::string(name) : table + '.' + std::string(name);
}

void EffectSurvey::note(std::string_view name, Value value) {
  const Level& level = levels_.back();
  if (level.there) {
    values_.insert_or_assign(path_of(name), std::move(value));
  } else if (!level.why_not.empty()) {
    left_out_.insert_or_assign(path_of(name), level.why_not);
  }
}

void EffectSurvey::integer(std::string_view name, std::int64_t& value, IntegerRange, Note) {
  note(name, {std::to_string(value)});
}

void EffectSurvey::choice_index(std::string_view name, std::size_t& index,
                                const std::vector<std::string_view>& names, Note) {
  note(name, {std::string(names[index]), true});
}

void EffectSurvey::enter(std::string_view name, bool there) {
  levels_.push_back({path_of(name), levels_.back().there && there, levels_.back().why_not,
                     levels_.back().belongs_to});
}

bool EffectSurvey::add(std::string_view name, bool present, const EffectNote& note) {
  const bool there = levels_.back().there && (present || note.implied);
  values_.insert_or_assign(path_of(name), Value{std::string(there ? kPresent : "absent")});
  effects_.push_back({path_of(name), there, std::string(note.help), note.cost, note.needs,
                      levels_.back().belongs_to});
  return there;
}

void EffectSurvey::begin_table(std::string_view name, Note) { enter(name, true); }
void EffectSurvey::end_table() { levels_.pop_back(); }

bool EffectSurvey::begin_effect(std::string_view name, bool& present, const EffectNote& note) {
  enter(name, add(name, present, note));
  return true;
}
void EffectSurvey::end_effect() { levels_.pop_back(); }

// The values in an item are none that an effect elsewhere could need.
bool EffectSurvey::begin_list(std::string_view name, std::size_t&, Note) {
  enter(name, false);
  return false;
}
void EffectSurvey::end_list() { levels_.pop_back(); }

void EffectSurvey::list_is_effect(std::string_view name, bool present, const EffectNote& note) {
  add(name, present, note);
}

bool EffectSurvey::begin_condition(const Condition& condition) {
  Level level{levels_.back().path, levels_.back().there && condition.holds(),
              levels_.back().why_not, levels_.back().belongs_to};
  if (!condition.holds() && !condition.why_not_beside.empty()) {
    level.why_not = "not beside [" + std::string(condition.key) + "]: " + condition.why_not_beside;
  } else if (!condition.holds() && !condition.values.empty()) {
    level.belongs_to = path_of(condition.key) + '=' + condition.values.front();
  }
  levels_.push_back(std::move(level));
  return true;
}
void EffectSurvey::end_condition() { levels_.pop_back(); }

const Effect* EffectSurvey::find(std::string_view path) const {
  const auto found = std::ranges::find(effects_, path, &Effect::path);
  return found == effects_.end() ? nullptr : &*found;
}

std::vector<std::string> EffectSurvey::to_bring(const Effect& effect) const {
  std::vector<std::string> settings;
  bring(effect, settings);
  return settings;
}

void EffectSurvey::bring(const Effect& effect, std::vector<std::string>& settings) const {
  const auto set = [&settings](std::string setting) {
    if (std::ranges::find(settings, setting) == settings.end()) {
      settings.push_back(std::move(setting));
    }
  };
  const auto bring_other = [&](const Effect* other) {
    if (other == nullptr || other->present) return;
    std::string setting = other->path + "=true";
    if (std::ranges::find(settings, setting) != settings.end()) return;
    bring(*other, settings);
    set(std::move(setting));
  };
  if (!effect.belongs_to.empty()) set(effect.belongs_to);
  for (std::size_t dot = effect.path.find('.'); dot != std::string::npos;
       dot = effect.path.find('.', dot + 1)) {
    bring_other(find(std::string_view(effect.path).substr(0, dot)));
  }
  for (const Need& need : effect.needs) {
    if (need.values.front() == kPresent) {
      bring_other(find(need.key));
      continue;
    }
    const auto value = values_.find(std::string(need.key));
    if (value != values_.end() &&
        std::ranges::find(need.values, value->second.text) != need.values.end()) {
      continue;
    }
    set(std::string(need.key) + '=' + std::string(need.values.front()));
  }
}

void EffectSurvey::require_needs() const {
  for (const Effect& effect : effects_) {
    if (!effect.present) continue;
    for (const Need& need : effect.needs) {
      const auto found = values_.find(std::string(need.key));
      if (const auto left_out = left_out_.find(std::string(need.key));
          left_out != left_out_.end()) {
        throw InputError(effect.path, left_out->second);
      }
      if (found == values_.end()) {
        throw std::logic_error(effect.path + " needs " + std::string(need.key) +
                               ", which is no choice and no whole number");
      }
      const Value& value = found->second;
      if (std::ranges::find(need.values, value.text) != need.values.end()) continue;
      const std::string because = need.why.empty() ? "" : std::string(need.why) + ": ";
      if (need.values.front() == kPresent) {
        throw InputError(effect.path, because + "expected [" + std::string(need.key) + "] too");
      }
      std::vector<std::string> wanted;
      for (const std::string_view accepted : need.values) wanted.push_back(value.shown(accepted));
      const std::string why = need.why.empty() ? "needs " : std::string(need.why) + ": expected ";
      throw InputError(effect.path, why + std::string(need.key) + " = " + alternatives(wanted) +
                                        ", found " + value.shown(value.text));
    }
  }
}

}  // namespace hvp::config
