#include "app/scenario/document.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "app/scenario/message.h"
#include "app/scenario/quantity.h"
#include "app/scenario/syntax.h"
#include "app/scenario/tree.h"
#include "models/files/regular_file.h"

namespace hvp::scenario {
namespace {

constexpr std::size_t kLargestFile = 1U << 20U;
constexpr std::size_t kLongestName = 1000;
constexpr std::string_view kBase = "base";
constexpr std::string_view kInclude = "include";
constexpr std::size_t kMostOnOneAnother = 9;
constexpr std::size_t kMostFiles = 100;

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

void set_file(Node& node, int file) {
  node.origin.file = file;
  for (Node& member : node.members) set_file(member, file);
}

Node parse_file(std::string_view text, const std::filesystem::path& file_name, bool included) {
  const std::string name = name_of(file_name);
  if (text.size() > kLargestFile) {
    throw SourceError(fmt::format("{}: is too large: expected at most 1 MiB", name));
  }
  Node root;
  try {
    root = parse_toml(text);
  } catch (const SyntaxError& error) {
    throw SourceError(fmt::format("{}:{}:{}: TOML syntax: {}", name, error.line, error.column,
                                  one_line(error.message, 400)));
  }
  // A file of `hvp fit` may consist of comments, if no key stands for its values.
  const bool comments = text.find('#') != std::string_view::npos;
  if (root.keys.empty() && !(included && comments)) {
    throw SourceError(fmt::format("{}: is empty: expected TOML tables", name));
  }
  return root;
}

std::string override_prefix(std::string_view text) { return "--set " + one_line(text) + ": "; }

}  // namespace

Document Document::load(const std::filesystem::path& file,
                        const std::vector<std::string>& overrides,
                        const std::vector<std::filesystem::path>& includes) {
  return of_text(read_text(file), file, overrides, includes);
}

Document Document::parse(std::string_view text, const std::filesystem::path& file_name,
                         const std::vector<std::string>& overrides) {
  return of_text(text, file_name, overrides, {});
}

Document Document::of_text(std::string_view text, const std::filesystem::path& file_name,
                           const std::vector<std::string>& overrides,
                           const std::vector<std::filesystem::path>& includes) {
  Document document;
  std::vector<Node> over;  // the last include first
  for (auto file = includes.rbegin(); file != includes.rend(); ++file) {
    over.push_back(document.stack(read_text(*file), *file, {}, true));
  }
  document.scenario_ = document.files_.size();
  document.root_ = document.stack(text, file_name, {}, false);
  for (auto node = over.rbegin(); node != over.rend(); ++node) {
    lay_over(std::move(*node), document.root_);
  }
  for (const std::string& item : overrides) document.apply(item);
  return document;
}

Node Document::stack(std::string_view text, const std::filesystem::path& file, Chain above,
                     bool included) {
  Node own = parse_file(text, file, included);
  set_file(own, static_cast<int>(files_.size()));
  above.push_back(files_.size());
  files_.push_back(file);
  const std::vector<Named> named = take_named(own);
  if (named.empty()) return own;
  std::vector<Node> below;
  below.reserve(named.size());
  for (const Named& one : named) below.push_back(stack_named(one, above));
  Node result = std::move(below.back());
  below.pop_back();
  for (auto node = below.rbegin(); node != below.rend(); ++node) {
    lay_over(std::move(*node), result);
  }
  lay_over(std::move(own), result);
  return result;
}

std::vector<Document::Named> Document::take_named(Node& own) const {
  std::vector<Named> named;
  if (const Node* include = own.find(kInclude)) {
    if (include->is_array()) {
      if (include->members.size() > kMostFiles) {
        throw SourceError(std::string(kInclude),
                          locate(include->origin, kInclude) +
                              fmt::format("expected at most {} files", kMostFiles));
      }
      for (std::size_t i = include->members.size(); i-- > 0;) {
        named.push_back({fmt::format("{}[{}]", kInclude, i), include->members[i]});
      }
    } else {
      named.push_back({std::string(kInclude), *include});
    }
    own.remove(kInclude);
  }
  if (const Node* base = own.find(kBase)) {
    named.push_back({std::string(kBase), *base});
    own.remove(kBase);
  }
  return named;
}

Node Document::stack_named(const Named& named, const Chain& above) {
  const bool is_base = named.key == kBase;
  const char* const kind = is_base ? "a scenario" : "a file of a scenario's keys";
  const auto wrong = [&](const std::string& message) {
    return SourceError(named.key, locate(named.text.origin, named.key) + message);
  };
  if (named.text.kind != Node::Kind::text || named.text.text.empty()) {
    throw wrong(fmt::format("expected the name of {} in quotes{}, found {}", kind,
                            is_base ? "" : ", or a list of such", found_text(named.text)));
  }
  if (above.size() == kMostOnOneAnother) {
    throw wrong(fmt::format("expected at most {} scenarios on one another", kMostOnOneAnother));
  }
  if (files_.size() == kMostFiles) {
    throw wrong(fmt::format("expected at most {} files in all", kMostFiles));
  }
  const std::filesystem::path file = files_[above.back()].parent_path() / named.text.text;
  const auto is_same = [&](std::size_t other) {
    std::error_code none_such;
    return std::filesystem::equivalent(file, files_[other], none_such);
  };
  if (std::ranges::any_of(above, is_same)) {
    throw wrong(fmt::format("expected no circle: {} already {}", name_of(file),
                            is_base ? "stands on this one" : "has this one below it"));
  }
  std::string text;
  try {
    text = files::read_regular_file(file, kLargestFile, kind);
  } catch (const InputError& error) {
    throw wrong(name_of(file) + ": " + error.what());
  }
  return stack(text, file, above, true);
}

namespace {

// Goes from `root` along a key as far as there are nodes. Returns the last one, and whether that is
// the key's own.
template <class Tree>
std::pair<Tree*, bool> along(Tree& root, std::string_view key) {
  Tree* place = &root;
  for (const KeyStep& step : split_key(key)) {
    Tree* next = place->is_table() ? place->find(step.name) : nullptr;
    if (next == nullptr) return {place, false};
    place = next;
    for (const std::size_t index : step.indices) {
      if (!place->is_array() || index >= place->members.size()) return {place, false};
      place = &place->members[index];
    }
  }
  return {place, true};
}

}  // namespace

void Document::put_text_under(std::string_view table, std::string_view text,
                              const std::filesystem::path& file_name) {
  Node lower = parse_file(text, file_name, false);
  set_file(lower, static_cast<int>(files_.size()));
  Node& upper = *along(root_, table).first;
  lay_over(std::move(upper), lower);
  upper = std::move(lower);
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
    // Blanks around `=` are allowed, as in a line pasted from a scenario: key = "value".
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
  // The command line's own paths are its caller's; one that is there only beside the scenario, as
  // in a study of it, is meant too.
  if (!origin.in_file() && std::filesystem::exists(path_in_scenario)) return path_in_scenario;
  const auto file = origin.in_file() ? static_cast<std::size_t>(origin.file) : scenario_;
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

const Node* Document::find(std::string_view key) const {
  const auto found = along(root_, key);
  return found.second ? found.first : nullptr;
}

// Returns the node of a key, or of the nearest table around it.
const Node& Document::at(std::string_view key) const { return *along(root_, key).first; }

std::string Document::locate(std::string_view key) const {
  if (key.empty()) return files_.empty() ? "" : name_of(files_[scenario_]) + ": ";
  return locate(at(key).origin, key);
}

SourceError Document::complete(const InputError& error) const {
  if (const auto* complete_already = dynamic_cast<const SourceError*>(&error)) {
    return *complete_already;
  }
  return {error.key(), locate(error.key()) + one_line(error.what(), 2000)};
}

}  // namespace hvp::scenario
