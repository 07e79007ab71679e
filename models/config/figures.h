#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <ranges>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

// The declaration of a part's figures, made once: the counterpart of config/declaration.h for
// results. A source of figures has a function `void report(config::Figures& f) const` that states
// the key, the unit, a line of help and the value of each. Writing summary.json, the page that
// explains it and the list of a study's columns are three visitors of that one declaration.
//
// A report() calls the visitor for all its figures, whatever their values. Figures that may be
// missing are declared with `optional`, if_present() and when(), so that a visitor that needs the
// declaration only gets all of it from a default-constructed source.
namespace hvp::config {

inline constexpr std::string_view kMicroseconds = "µs";

// A figure's value in the unit of its key. monostate: there is none, which is null in summary.json.
using FigureValue = std::variant<std::monostate, bool, std::int64_t, double, std::string,
                                 std::vector<std::string>, std::vector<double>>;

class Figures {
 public:
  virtual ~Figures() = default;

  // Declares a figure. `key` is within the present table. `unit` is that of the value: "µs", "N";
  // empty for a count, a ratio or a name. The help is Markdown.
  virtual void value(std::string_view key, const FigureValue& value, std::string_view unit,
                     std::string_view help) = 0;

  // A time in µs. Its value is the double nearest to the exact one, which prints without a tail:
  // 651.34. The key ends in "_us".
  void time(std::string_view key, std::int64_t picoseconds, std::string_view help) {
    value(key, static_cast<double>(picoseconds) / 1e6, kMicroseconds, help);
  }
  // A mean of times, in µs.
  void mean_time(std::string_view key, double picoseconds, std::string_view help) {
    value(key, picoseconds / 1e6, kMicroseconds, help);
  }
  void quantity(std::string_view key, std::optional<double> number, std::string_view unit,
                std::string_view help) {
    value(key, number ? FigureValue(*number) : FigureValue(), unit, help);
  }
  // A share, or a relative error.
  void ratio(std::string_view key, std::optional<double> number, std::string_view help) {
    quantity(key, number, {}, help);
  }
  void count(std::string_view key, std::integral auto number, std::string_view help) {
    value(key, static_cast<std::int64_t>(number), {}, help);
  }
  void count(std::string_view key, std::optional<std::int64_t> number, std::string_view help) {
    value(key, number ? FigureValue(*number) : FigureValue(), {}, help);
  }
  // A frame's number; below zero there is none.
  void frame(std::string_view key, std::int64_t number, std::string_view help) {
    value(key, number >= 0 ? FigureValue(number) : FigureValue(), {}, help);
  }
  void truth(std::string_view key, bool holds, std::string_view help) {
    value(key, holds, {}, help);
  }
  void text(std::string_view key, std::string_view words, std::string_view help) {
    value(key, std::string(words), {}, help);
  }

  // Figures in a table of their own: of a source with report(), or of a function that declares
  // them. A table that is named again is continued.
  template <class Part>
  void table(std::string_view key, std::string_view help, const Part& part) {
    begin_table(key, help);
    report(part);
    end_table();
  }
  // A table that is null where the part is absent. `of` reports the part where it has no report()
  // of its own.
  template <class Part>
  void table_or_null(std::string_view key, std::string_view help, const std::optional<Part>& part) {
    table_or_null(key, help, part, [this](const Part& p) { p.report(*this); });
  }
  template <class Part, class Of>
  void table_or_null(std::string_view key, std::string_view help, const std::optional<Part>& part,
                     const Of& of) {
    if (!part && !describes_only()) return value(key, {}, {}, help);
    table(key, help, [&] { present(part, of); });
  }
  // A table that is left out where the part is absent.
  template <class Part>
  void table_if_present(std::string_view key, std::string_view help,
                        const std::optional<Part>& part) {
    if (part || describes_only()) table(key, help, part ? *part : Part{});
  }
  // Figures that are left out where the part is absent.
  template <class Part, class Of>
  void if_present(const std::optional<Part>& part, const Of& of) {
    if (part || describes_only()) present(part, of);
  }
  // Figures that are left out where they do not belong.
  template <class Of>
  void when(bool belongs, const Of& of) {
    if (belongs || describes_only()) of();
  }

  // A list of tables, one for each item. `of` reports an item that has no report() of its own.
  template <class Items>
  void list(std::string_view key, std::string_view help, const Items& items) {
    list(key, help, items, [this](const auto& item) { item.report(*this); });
  }
  template <class Items, class Of>
  void list(std::string_view key, std::string_view help, const Items& items, const Of& of) {
    begin_list(key, help);
    const auto one = [&](const auto& item) {
      begin_item();
      of(item);
      end_item();
    };
    if (describes_only()) {
      one(std::ranges::range_value_t<Items>{});
    } else {
      for (const auto& item : items) one(item);
    }
    end_list();
  }

  // A table of tables, one for each item, with the names that `name` gives; the page calls them
  // <item>.
  template <class Items, class Name>
  void tables(std::string_view key, std::string_view help, const Items& items, const Name& name) {
    begin_table(key, help);
    if (describes_only()) {
      table("<item>", {}, std::ranges::range_value_t<Items>{});
    } else {
      for (const auto& item : items) table(name(item), {}, item);
    }
    end_table();
  }

  // The figures of a part, among those of the present table.
  template <class Part>
  void report(const Part& part) {
    if constexpr (requires { part.report(*this); }) {
      part.report(*this);
    } else {
      part();
    }
  }

 protected:
  virtual void begin_table(std::string_view key, std::string_view help) = 0;
  virtual void end_table() = 0;
  virtual void begin_list(std::string_view key, std::string_view help) = 0;
  virtual void begin_item() = 0;
  virtual void end_item() = 0;
  virtual void end_list() = 0;
  // True for a visitor that needs the declaration and not the values: it is shown every part and
  // one item of every list, default-constructed where there is none.
  virtual bool describes_only() const { return false; }

 private:
  template <class Part, class Of>
  static void present(const std::optional<Part>& part, const Of& of) {
    of(part ? *part : Part{});
  }
};

}  // namespace hvp::config
