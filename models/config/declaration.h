#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

// The declaration of a part's parameters, made once. A configuration struct is kept with its part
// and has a member `void declare(config::Visitor& v)` that names every parameter with its
// dimension, range, help and the source of its default (the default itself is the member's
// initialiser). Reading a scenario, checking it, writing scenario.resolved.toml and the reference
// page are four visitors of that one declaration. A rule that concerns several parameters together
// goes into `void check() const`, which throws InputError naming one of the part's own keys.
namespace hvp::config {

// The dimension of a quantity. Values are stored in SI units; a scenario states the unit.
enum class Dimension {
  dimensionless,
  time,              // s
  frequency,         // Hz
  rate,              // 1/s (Rayleigh's mass coefficient)
  length,            // m
  mass,              // kg
  velocity,          // m/s
  acceleration,      // m/s²
  force,             // N
  stiffness,         // N/m
  damping,           // N·s/m
  pressure,          // Pa
  density,           // kg/m³
  angle,             // rad
  inertia,           // kg·m²
  current,           // A
  voltage,           // V
  transconductance,  // A/V
  torque_constant,   // N·m/A
  throughput,        // operations a second (flop/s)
  bandwidth,         // bytes a second
  data_size,         // bytes
};

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Admissible values; a bound counts as admissible unless it is open.
struct Range {
  double min = -kInfinity;
  double max = kInfinity;
  bool min_open = false;
  bool max_open = false;
};
constexpr Range at_least(double min) { return {.min = min}; }
constexpr Range above(double min) { return {.min = min, .min_open = true}; }
constexpr Range between(double min, double max) { return {.min = min, .max = max}; }

struct IntegerRange {
  std::int64_t min = std::numeric_limits<std::int64_t>::min();
  std::int64_t max = std::numeric_limits<std::int64_t>::max();
};

// One line of help, and the source of the default (a paper's section, a data sheet, a measurement).
// A required parameter has no default. A `word` may stand in the place of a quantity: it is 0,
// which its range does not admit.
struct Note {
  std::string_view help;
  std::string_view source = {};
  bool required = false;
  std::string_view word = {};
};

// Stands for the value of an effect that is present.
inline constexpr std::string_view kPresent = "present";

// A condition elsewhere in the scenario without which an effect does nothing.
struct Need {
  std::string_view key;  // key of a choice, a whole number or, with kPresent, an effect
  std::vector<std::string_view> values;  // one of these is needed; without quotes
  std::string_view why = {};             // "a bus that takes no time has no latencies"
};

// An effect's declaration of itself. `hvp explain`, summary.json and the reference page take it
// from here, and nothing else lists effects.
struct EffectNote {
  std::string_view help;
  // What is built for the effect, and its cost in simulated and in real time.
  std::string cost = {};
  std::vector<Need> needs = {};
  // The effect may be present without its table too, because of a key that is declared before it.
  bool implied = false;
};

// A condition under which keys belong to a table: some values of another key, such as "sphere" for
// the radius. A key in a scenario that does not belong is refused, whatever its value.
struct Condition {
  std::string_view key;             // "shape"
  std::vector<std::string> values;  // as in a scenario: "\"sphere\"", "1"
  std::string found;                // the present value, written the same way
  // For keys that belong unless a table is present: `key` is that table, and this is the reason.
  std::string why_not_beside = {};
  bool holds() const { return std::find(values.begin(), values.end(), found) != values.end(); }
};

// The condition of keys that do nothing beside another table, such as "wall"; `there`: that table
// is present.
inline Condition not_beside(std::string_view table, bool there, std::string why) {
  return {table, {"absent"}, there ? "present" : "absent", std::move(why)};
}

// A file. Its path is relative to the program's own folder and can be opened once the scenario is
// loaded.
struct File {
  std::string written;  // as the scenario writes it; empty: none
  std::string path;

  File() = default;
  explicit File(const std::string& name) : written(name), path(name) {}
  bool empty() const { return written.empty(); }
  bool operator==(const File&) const = default;
};

class Visitor;

// A choice that decides which other keys belong to the table.
template <class Enum>
class Variant {
 public:
  using Options = std::vector<std::pair<std::string_view, Enum>>;

  Variant(Visitor& visitor, std::string_view key, Options options, Enum found)
      : visitor_(visitor), key_(key), options_(std::move(options)), found_(found) {}

  // Declares the keys that belong to these values only.
  template <class Declare>
  void only(std::initializer_list<Enum> values, const Declare& declare) const;

 private:
  std::string text(Enum value) const {
    for (const auto& [name, option] : options_) {
      if (option == value) return '"' + std::string(name) + '"';
    }
    return {};
  }

  Visitor& visitor_;
  std::string_view key_;
  Options options_;
  Enum found_;
};

class Visitor {
 public:
  virtual ~Visitor() = default;

  // Visits a whole declaration.
  template <class Root>
  void visit(Root& root) {
    declare_and_check(root);
  }

  virtual void quantity(std::string_view name, double& value, Dimension, Range, Note) = 0;
  // Three components of one dimension: ["0 mm", "0 mm", "50 mm"].
  virtual void vector(std::string_view name, Eigen::Vector3d& value, Dimension, Range, Note) = 0;
  virtual void integer(std::string_view name, std::int64_t& value, IntegerRange, Note) = 0;
  virtual void boolean(std::string_view name, bool& value, Note) = 0;
  virtual void text(std::string_view name, std::string& value, Note) = 0;
  // A file; a relative path starts from the scenario's folder. An empty one is absent.
  virtual void file(std::string_view name, File& file, Note) = 0;
  // One of several names; `index` is into `names`.
  virtual void choice_index(std::string_view name, std::size_t& index,
                            const std::vector<std::string_view>& names, Note) = 0;

  void integer(std::string_view name, int& value, IntegerRange range, Note note) {
    std::int64_t wide = value;
    range.min = std::max<std::int64_t>(range.min, std::numeric_limits<int>::min());
    range.max = std::min<std::int64_t>(range.max, std::numeric_limits<int>::max());
    integer(name, wide, range, note);
    value = static_cast<int>(wide);
  }

  // An enumeration by its names, in the order in which the reference page lists them.
  template <class Enum>
  void choice(std::string_view name, Enum& value,
              const std::vector<std::pair<std::string_view, Enum>>& options, Note note) {
    std::vector<std::string_view> names;
    std::size_t index = 0;
    for (std::size_t i = 0; i < options.size(); ++i) {
      names.push_back(options[i].first);
      if (options[i].second == value) index = i;
    }
    choice_index(name, index, names, note);
    value = options[index].second;
  }

  // The same for a choice that decides which keys follow.
  template <class Enum>
  Variant<Enum> variant(std::string_view name, Enum& value,
                        const std::vector<std::pair<std::string_view, Enum>>& options, Note note) {
    choice(name, value, options, note);
    return {*this, name, options, value};
  }

  // Declares keys that belong only where the condition holds.
  template <class Declare>
  void when(const Condition& condition, const Declare& declare) {
    if (!begin_condition(condition)) return;
    declare();
    end_condition();
  }

  // Declares a part whose keys are in the present table, among those of the part that includes it.
  template <class Part>
  void include(Part& part) {
    part.declare(*this);
    if constexpr (requires { part.check(); }) {
      included_.push_back([&part] { part.check(); });
    }
  }

  // Declares a part that is always present; its table may be left out and then has its defaults.
  // `context` decides from elsewhere which of its keys belong.
  template <class Part, class... Context>
  void table(std::string_view name, Part& part, Note note, const Context&... context) {
    begin_table(name, note);
    declare_and_check(part, context...);
    end_table();
  }

  // Declares a part of which there is one, written as a table, or several, written as an array of
  // tables.
  template <class Part>
  void one_or_more(std::string_view name, std::vector<Part>& parts, Note note) {
    if (parts.empty()) parts.resize(1);
    if (is_list(name, parts.size())) {
      list(name, parts, note);
      return;
    }
    parts.resize(1);
    table(name, parts.front(), note);
  }

  // Declares a table that may be left out and is then absent: something else takes its place, and
  // it is no effect. `name = true` of --set makes one with its defaults.
  template <class Part>
  void optional_table(std::string_view name, std::optional<Part>& part, Note note) {
    bool present = part.has_value();
    const bool enter = begin_optional(name, present, note);
    if (describes_only()) return;
    if (!present) part.reset();
    if (!enter) return;
    if (!part) part.emplace();
    declare_and_check(*part);
    end_optional();
  }

  // Declares an effect: it is present if and only if the scenario has its table.
  template <class Part>
  void effect(std::string_view name, std::optional<Part>& part, const EffectNote& note) {
    bool present = part.has_value();
    const bool enter = begin_effect(name, present, note);
    if (describes_only()) {
      if (!enter) return;
      Part typical = part.value_or(Part{});
      declare_and_check(typical);
      end_effect();
      return;
    }
    if (!present) part.reset();
    if (!enter) return;
    if (!part) part.emplace();
    declare_and_check(*part);
    end_effect();
  }

  // Declares an effect that is present where its list has an item.
  template <class Part>
  void effects(std::string_view name, std::vector<Part>& parts, const EffectNote& note) {
    list(name, parts, {.help = note.help});
    list_is_effect(name, !parts.empty(), note);
  }

  // Declares an array of tables. A list in the scenario replaces the default one as a whole.
  // `context` is what an item's declaration takes from elsewhere.
  template <class Part, class... Context>
  void list(std::string_view name, std::vector<Part>& parts, Note note, const Context&... context) {
    std::size_t count = parts.size();
    const bool replaced = begin_list(name, count, note);
    if (describes_only()) {
      Part typical{};
      begin_item(0);
      declare_and_check(typical, context...);
      end_item();
    } else {
      if (replaced) parts.clear();
      parts.resize(count);
      for (std::size_t i = 0; i < count; ++i) {
        begin_item(i);
        declare_and_check(parts[i], context...);
        end_item();
      }
    }
    end_list();
  }

 protected:
  virtual void begin_table(std::string_view name, Note) = 0;
  virtual void end_table() = 0;
  // Returns true where the visit is to enter the part. A reader sets `present`.
  virtual bool begin_effect(std::string_view name, bool& present, const EffectNote&) = 0;
  virtual void end_effect() = 0;
  // Likewise. A visitor that needs the declaration only sees that there is such a table, whose keys
  // are those of another one.
  virtual bool begin_optional(std::string_view /*name*/, bool& /*present*/, Note) { return false; }
  virtual void end_optional() {}
  // Says that the list that has just ended is an effect.
  virtual void list_is_effect(std::string_view /*name*/, bool /*present*/, const EffectNote&) {}
  // True where a part of one_or_more() is an array of tables.
  virtual bool is_list(std::string_view /*name*/, std::size_t count) { return count > 1; }
  // A reader sets `count` and returns true where the scenario has the list.
  virtual bool begin_list(std::string_view name, std::size_t& count, Note) = 0;
  virtual void begin_item(std::size_t index) = 0;
  virtual void end_item() = 0;
  virtual void end_list() = 0;
  // Returns true where the visit is to go on to the keys: for a reader always, so that it knows
  // them, and for a writer where they belong.
  virtual bool begin_condition(const Condition& /*condition*/) { return true; }
  virtual void end_condition() {}
  // A reader runs the check and completes the key of the error that it throws; other visitors do
  // nothing.
  virtual void check(const std::function<void()>& /*rule*/) {}
  // True for a visitor that needs the declaration only: it is shown every effect, an absent one
  // with its defaults, and one item of every list with its defaults, and changes nothing.
  virtual bool describes_only() const { return false; }

 private:
  using Rules = std::vector<std::function<void()>>;

  // Declares a part and then runs its rules, once the whole table is declared: those of included
  // parts first.
  template <class Part, class... Context>
  void declare_and_check(Part& part, const Context&... context) {
    Rules outer = std::exchange(included_, {});
    part.declare(*this, context...);
    Rules rules = std::exchange(included_, std::move(outer));
    if constexpr (requires { part.check(); }) {
      rules.push_back([&part] { part.check(); });
    }
    if (rules.empty()) return;
    check([&rules] {
      for (const auto& rule : rules) rule();
    });
  }

  Rules included_;  // of the present table
};

template <class Enum>
template <class Declare>
void Variant<Enum>::only(std::initializer_list<Enum> values, const Declare& declare) const {
  Condition condition{key_, {}, text(found_)};
  for (const Enum value : values) condition.values.push_back(text(value));
  visitor_.when(condition, declare);
}

}  // namespace hvp::config
