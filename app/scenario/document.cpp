#include "app/scenario/document.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "app/scenario/message.h"
#include "app/scenario/override.h"
#include "app/scenario/syntax.h"
#include "models/files/regular_file.h"

namespace hvp::scenario {
namespace {

constexpr std::size_t kLargestFile = 1U << 20U;
constexpr std::size_t kLongestName = 1000;
constexpr std::string_view kBase = "base";
constexpr std::size_t kMostFiles = 9;

std::string name_of(const std::filesystem::path& file) {
  return one_line(file.string(), kLongestName);
}

std::string read_text(const std::filesystem::path& file) {
  try {
    return files::read_regular_file(file, kLargestFile, "a scenario");
  } catch (const InputError& error) {
    throw SourceError(fmt::format("{}: {}", name_of(file), error.what()));
  }
}

// A line of a scenario can be pasted: key = "value".
std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

void set_file(Node& node, int file) {
  node.origin.file = file;
  for (Node& member : node.members) set_file(member, file);
}

std::string override_prefix(std::string_view text) { return "--set " + one_line(text) + ": "; }

}  // namespace

Document Document::load(const std::filesystem::path& file,
                        const std::vector<std::string>& overrides) {
  return parse(read_text(file), file, overrides);
}

Document Document::parse_file(std::string_view text, const std::filesystem::path& file_name) {
  Document document;
  document.files_ = {file_name};
  const std::string name = name_of(file_name);
  if (text.size() > kLargestFile) {
    throw SourceError(fmt::format("{}: is too large: expected at most 1 MiB", name));
  }
  try {
    document.root_ = parse_toml(text);
  } catch (const SyntaxError& error) {
    throw SourceError(fmt::format("{}:{}:{}: TOML syntax: {}", name, error.line, error.column,
                                  one_line(error.message, 400)));
  }
  if (document.root_.keys.empty()) {
    throw SourceError(fmt::format("{}: is empty: expected TOML tables", name));
  }
  return document;
}

Document Document::parse(std::string_view text, const std::filesystem::path& file_name,
                         const std::vector<std::string>& overrides) {
  Document document = parse_file(text, file_name);
  while (document.root_.find(kBase) != nullptr) document.put_on_base();
  for (const std::string& item : overrides) document.apply(item);
  return document;
}

void Document::put_on_base() {
  const Node named = *root_.find(kBase);
  const auto wrong = [&](const std::string& message) {
    return SourceError(std::string(kBase), locate(named.origin, kBase) + message);
  };
  if (named.kind != Node::Kind::text || named.text.empty()) {
    throw wrong(
        fmt::format("expected the name of a scenario in quotes, found {}", found_text(named)));
  }
  if (files_.size() == kMostFiles) {
    throw wrong(fmt::format("expected at most {} scenarios on one another", kMostFiles));
  }
  const std::filesystem::path file = resolve(kBase, named.text);
  const auto is_same = [&file](const std::filesystem::path& other) {
    std::error_code none_such;
    return std::filesystem::equivalent(file, other, none_such);
  };
  if (std::ranges::any_of(files_, is_same)) {
    throw wrong(fmt::format("expected no circle: {} already stands on this one", name_of(file)));
  }
  try {
    Document base = parse_file(files::read_regular_file(file, kLargestFile, "a scenario"), file);
    set_file(base.root_, static_cast<int>(files_.size()));
    root_.remove(kBase);
    lay_over(std::move(root_), base.root_);
    root_ = std::move(base.root_);
    files_.push_back(file);
  } catch (const SourceError&) {
    throw;
  } catch (const InputError& error) {
    throw wrong(name_of(file) + ": " + error.what());
  }
}

void Document::put_text_under(std::string_view table, std::string_view text,
                              const std::filesystem::path& file_name) {
  Document lower = parse_file(text, file_name);
  set_file(lower.root_, static_cast<int>(files_.size()));
  Node wrapped;
  wrapped.add(table, std::move(lower.root_));
  lay_over(std::move(root_), wrapped);
  root_ = std::move(wrapped);
  files_.push_back(file_name);
}

void Document::put_file_under(std::string_view table, const std::filesystem::path& file) {
  put_text_under(table, read_text(file), file);
}

Document Document::of_overrides(const std::vector<std::string>& overrides) {
  Document document;
  for (const std::string& item : overrides) document.apply(item);
  return document;
}

void Document::apply(const std::string& text) {
  const int index = static_cast<int>(overrides_.size());
  const auto equals = text.find('=');
  try {
    if (text.size() > kLargestFile) throw InputError("is too large");
    const std::string key(trimmed(std::string_view(text).substr(0, equals)));
    if (equals == std::string::npos || key.empty()) {
      throw InputError("expected KEY=VALUE, such as object.mesh.nodes=300");
    }
    overrides_.push_back({key, text});
    put(root_, key, override_value(trimmed(std::string_view(text).substr(equals + 1)), index));
  } catch (const InputError& error) {
    throw SourceError(override_prefix(text) + error.what());
  }
}

std::filesystem::path Document::resolve(std::string_view key,
                                        const std::string& path_in_scenario) const {
  if (files_.empty()) return path_in_scenario;
  const Origin& origin = at(key).origin;
  const auto file = static_cast<std::size_t>(origin.in_file() ? origin.file : 0);
  return files_[file].parent_path() / path_in_scenario;  // an absolute path stays as it is
}

std::string Document::locate(const Origin& origin, std::string_view key) const {
  std::string shown = key.empty() ? "" : one_line(key) + ": ";
  if (origin.in_file()) {
    if (files_.empty()) return shown;
    const std::filesystem::path& file = files_[static_cast<std::size_t>(origin.file)];
    return fmt::format("{}:{}: {}", name_of(file), origin.line, shown);
  }
  const Override& source = overrides_.at(static_cast<std::size_t>(origin.override_index));
  return override_prefix(source.text) + (source.key == key ? "" : shown);
}

// What the scenario says of a key, or of the nearest table around it.
const Node& Document::at(std::string_view key) const {
  const Node* place = &root_;
  for (const KeyStep& step : split_key(key)) {
    const Node* next = place->is_table() ? place->find(step.name) : nullptr;
    if (next == nullptr) break;
    place = next;
    for (const std::size_t index : step.indices) {
      if (!place->is_array() || index >= place->members.size()) break;
      place = &place->members[index];
    }
  }
  return *place;
}

std::string Document::locate(std::string_view key) const {
  if (key.empty()) return files_.empty() ? "" : name_of(files_.front()) + ": ";
  return locate(at(key).origin, key);
}

SourceError Document::complete(const InputError& error) const {
  if (const auto* complete_already = dynamic_cast<const SourceError*>(&error)) {
    return *complete_already;
  }
  return {error.key(), locate(error.key()) + one_line(error.what(), 2000)};
}

}  // namespace hvp::scenario
