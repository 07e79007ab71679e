#include "app/scenario/document.h"

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

std::string override_prefix(std::string_view text) { return "--set " + one_line(text) + ": "; }

}  // namespace

Document Document::load(const std::filesystem::path& file,
                        const std::vector<std::string>& overrides) {
  return parse(read_text(file), file, overrides);
}

Document Document::parse(std::string_view text, const std::filesystem::path& file_name,
                         const std::vector<std::string>& overrides) {
  Document document;
  document.file_ = file_name;
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
  for (const std::string& item : overrides) document.apply(item);
  return document;
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

std::filesystem::path Document::resolve(const std::string& path_in_scenario) const {
  return file_.parent_path() / path_in_scenario;  // an absolute path stays as it is
}

std::string Document::locate(const Origin& origin, std::string_view key) const {
  std::string shown = key.empty() ? "" : one_line(key) + ": ";
  if (origin.in_file() && file_.empty()) return shown;
  if (origin.in_file()) return fmt::format("{}:{}: {}", name_of(file_), origin.line, shown);
  const Override& source = overrides_.at(static_cast<std::size_t>(origin.override_index));
  return override_prefix(source.text) + (source.key == key ? "" : shown);
}

std::string Document::locate(std::string_view key) const {
  if (key.empty()) return file_.empty() ? "" : name_of(file_) + ": ";
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
  return locate(place->origin, key);
}

SourceError Document::complete(const InputError& error) const {
  if (const auto* complete_already = dynamic_cast<const SourceError*>(&error)) {
    return *complete_already;
  }
  return {error.key(), locate(error.key()) + one_line(error.what(), 2000)};
}

}  // namespace hvp::scenario
