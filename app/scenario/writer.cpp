#include "app/scenario/writer.h"

#include <utility>

#include <fmt/format.h>

#include "app/scenario/message.h"

namespace hvp::scenario {

using config::Note;

Writer::Writer() : stack_{&root_} {}

std::string Writer::text() const {
  std::string result = "# Every parameter of the scenario with the value it has.\n";
  append(root_, result);
  return result;
}

void Writer::append(const Table& table, std::string& text) {
  if (!table.header.empty()) text += "\n" + table.header + "\n";
  text += table.lines;
  for (const auto& child : table.children) append(*child, text);
}

void Writer::line(std::string_view name, std::string_view value) {
  stack_.back()->lines += fmt::format("{} = {}\n", key_text(name), value);
}

Writer::Table& Writer::open(const std::string& path, std::string header) {
  auto& children = stack_.back()->children;
  children.push_back(std::make_unique<Table>());
  children.back()->path = path;
  children.back()->header = std::move(header);
  return *children.back();
}

void Writer::key(std::string_view name, const Key& key, const Note& /*note*/) {
  line(name, toml_value(key));
}

void Writer::begin_table(std::string_view name, Note) {
  const std::string path = joined(stack_.back()->path, key_text(name));
  stack_.push_back(&open(path, "[" + path + "]"));
}

void Writer::end_table() { stack_.pop_back(); }

bool Writer::begin_effect(std::string_view name, bool& present, const config::EffectNote&) {
  const std::string path = joined(stack_.back()->path, key_text(name));
  if (present) {
    stack_.push_back(&open(path, "[" + path + "]"));
  } else {
    open(path, "# [" + path + "] is not in this scenario");
  }
  return present;
}

bool Writer::begin_optional(std::string_view name, bool& present, Note note) {
  if (present) begin_table(name, note);
  return present;
}

void Writer::end_effect() { stack_.pop_back(); }

bool Writer::begin_list(std::string_view name, std::size_t& count, Note) {
  if (count == 0) line(name, "[]");
  lists_.push_back(joined(stack_.back()->path, key_text(name)));
  return false;
}

void Writer::begin_item(std::size_t /*index*/) {
  stack_.push_back(&open(lists_.back(), "[[" + lists_.back() + "]]"));
}

void Writer::end_item() { stack_.pop_back(); }

void Writer::end_list() { lists_.pop_back(); }

}  // namespace hvp::scenario
