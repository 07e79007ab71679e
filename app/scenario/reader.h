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

// Fills a declared struct from a document. After an error it continues with the default, and
// finish() throws the first error: wrong keys and values in the order of their lines, then missing
// keys, then violated rules of a part. Rules are checked only while there is no other error, so
// that all values are in range.
class Reader : public config::Visitor {
 public:
  explicit Reader(const Document& document);

  // Throws the first error, a SourceError. `outline` is called only for an unknown key, to find the
  // name that was meant.
  void finish(const std::function<Outline()>& outline);
  // Checks a rule of the current part.
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
  bool begin_optional(std::string_view name, bool& present, config::Note note) override {
    return begin_effect(name, present, {.help = note.help});
  }
  void end_optional() override { leave(); }
  bool is_list(std::string_view name, std::size_t count) override;
  bool begin_list(std::string_view name, std::size_t& count, config::Note note) override;
  void begin_item(std::size_t index) override;
  void end_item() override { leave(); }
  void end_list() override { lists_.pop_back(); }
  bool begin_condition(const config::Condition& condition) override;
  void end_condition() override { levels_.back().conditions.pop_back(); }

 private:
  // A table that is being read. Without a node, all its keys have their defaults.
  struct Level {
    const Node* node = nullptr;
    std::string path;     // with indices: "contacts[0].shape"
    std::string generic;  // without indices: "contacts.shape", as in the outline
    Origin origin;        // of the nearest table that is in the scenario
    // True if the name or switch that decides which keys belong here was wrong.
    bool uncertain = false;
    // True for an item of a default list and for a table that does not belong: no required key is
    // missing then.
    bool given = false;
    // True for a table that does not belong: its requirements are not reported.
    bool left_out = false;
    std::vector<std::string> declared = {};
    std::vector<config::Condition> conditions = {};  // of the keys being declared
  };
  struct List {
    const Node* node = nullptr;
    std::string path;
    std::string generic;
  };
  // The data that finish() needs to suggest the key that was meant.
  struct Unknown {
    std::string name;
    std::string table;  // without indices
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
  // Returns a condition of the current keys that is not met, or nullptr if all are met.
  const config::Condition* unmet_condition() const;
  std::string key_of(std::string_view name) const;
  void wrong(const Node& node, std::string key, std::string message);
  bool precedes_first(Stage stage, const Origin& origin) const;
  void enter(Level level);
  void leave();
  void reject_unknown_keys(const Level& level);
  bool read_quantity(const Node& node, const std::string& key, double& value,
                     config::Dimension dimension, const config::Range& range,
                     std::string_view word = {});
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
