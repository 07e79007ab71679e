#include "app/scenario/key_visitor.h"

#include "app/scenario/toml_text.h"

namespace hvp::scenario {

std::string toml_value(const Key& key) {
  struct Writing {
    config::Dimension dimension;
    std::string operator()(double value) const { return toml_quantity(value, dimension); }
    std::string operator()(const Eigen::Vector3d& value) const {
      return toml_vector(value, dimension);
    }
    std::string operator()(std::int64_t value) const { return std::to_string(value); }
    std::string operator()(bool value) const { return value ? "true" : "false"; }
    std::string operator()(const std::string& value) const { return toml_string(value); }
  };
  return std::visit(Writing{key.dimension}, key.value);
}

void KeyVisitor::quantity(std::string_view name, double& value, config::Dimension dimension,
                          config::Range range, config::Note note) {
  Key quantity{Key::Kind::quantity, value, dimension, range};
  quantity.word = note.word;
  if (!note.word.empty() && value == 0) quantity.value = std::string(note.word);
  key(name, quantity, note);
}

void KeyVisitor::vector(std::string_view name, Eigen::Vector3d& value, config::Dimension dimension,
                        config::Range range, config::Note note) {
  key(name, {Key::Kind::vector, value, dimension, range}, note);
}

void KeyVisitor::integer(std::string_view name, std::int64_t& value, config::IntegerRange range,
                         config::Note note) {
  key(name, {.kind = Key::Kind::integer, .value = value, .integers = range}, note);
}

void KeyVisitor::boolean(std::string_view name, bool& value, config::Note note) {
  key(name, {Key::Kind::boolean, value}, note);
}

void KeyVisitor::text(std::string_view name, std::string& value, config::Note note) {
  key(name, {Key::Kind::text, value}, note);
}

void KeyVisitor::file(std::string_view name, config::File& file, config::Note note) {
  key(name, {Key::Kind::file, file.written}, note);
}

void KeyVisitor::choice_index(std::string_view name, std::size_t& index,
                              const std::vector<std::string_view>& names, config::Note note) {
  key(name,
      {.kind = Key::Kind::choice,
       .value = std::string(names.at(index)),
       .choices = {names.begin(), names.end()}},
      note);
}

}  // namespace hvp::scenario
