#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/scenario/document.h"
#include "app/scenario/outline.h"
#include "models/config/declaration.h"

namespace hvp::scenario {

// Fills a declared struct from a document. It goes on after an error with the default in place,
// and finish() throws the one that stands first: what the scenario says wrongly in the order of
// its lines, then what it lacks, then what a part's own rule refuses. Those rules only run while
// nothing is wrong, on values that are all in range.
class Reader : public config::Visitor {
 public:
  explicit Reader(const Document& document);

  // Throws the first error, a SourceError. `outline` is asked for names that were meant, and
  // only when there is an unknown key.
  void finish(const std::function<Outline()>& outline);
  // Runs the rule of the part at hand.
  void check(const std::function<void()>& rule) override;

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
  void end_table() override { leave(); }
  bool begin_effect(std::string_view name, bool& present, const config::EffectNote& note) override;
  void end_effect() override { leave(); }
  bool is_list(std::string_view name, std::size_t count) override;
  bool begin_list(std::string_view name, std::size_t& count, config::Note note) override;
  void begin_item(std::size_t index) override;
  void end_item() override { leave(); }
  void end_list() override { lists_.pop_back(); }
  bool begin_condition(const config::Condition& condition) override;
  void end_condition() override { levels_.back().conditions.pop_back(); }

 private:
  // A table that is being read. Without a node it stands at its defaults.
  struct Level {
    const Node* node = nullptr;
    std::string path;     // with indices: "contacts[0].shape"
    std::string generic;  // without: "contacts.shape", as in the outline
    Origin origin;        // of the nearest table that the scenario has
    // A name or switch that decides what else belongs here was wrong.
    bool uncertain = false;
    // An item of a default list, or a table that does not belong: it holds what it needs without
    // being read.
    bool given = false;
    // A table that does not belong: what it would have to be is nobody's matter.
    bool left_out = false;
    std::vector<std::string> declared = {};
    std::vector<config::Condition> conditions = {};  // of the keys that are being declared
  };
  struct List {
    const Node* node = nullptr;
    std::string path;
    std::string generic;
  };
  // What finish() needs to say which key was meant.
  struct Unknown {
    std::string name;
    std::string table;  // generic path
    std::vector<std::string> declared;
  };
  enum class Stage { wrong, missing, refused };
  struct Error {
    Stage stage = Stage::wrong;
    Origin origin;
    std::string key;
    std::string message;
    std::optional<Unknown> unknown = {};
  };

  const Node* find(std::string_view name) const;
  const Node* take(std::string_view name, const config::Note& note);
  // Of the keys that are being declared, one that does not hold; nullptr where all do.
  const config::Condition* unmet_condition() const;
  std::string key_of(std::string_view name) const;
  void wrong(const Node& node, std::string key, std::string message);
  bool precedes_first(Stage stage, const Origin& origin) const;
  void enter(Level level);
  void leave();
  void reject_unknown_keys(const Level& level);
  bool read_quantity(const Node& node, const std::string& key, double& value,
                     config::Dimension dimension, const config::Range& range);
  bool read_text(const Node& node, const std::string& key, std::string_view expected,
                 std::string& value);

  const Document& document_;
  std::vector<Level> levels_;
  std::vector<List> lists_;
  std::optional<Error> first_;
};

// Reads the whole document into `root`, whose values are the defaults. Throws SourceError.
template <class Root>
void read(const Document& document, Root& root) {
  Reader reader(document);
  reader.visit(root);
  reader.finish([&root] { return describe(root); });
}

}  // namespace hvp::scenario
