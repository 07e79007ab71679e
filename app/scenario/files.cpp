#include "app/scenario/files.h"

#include <fmt/format.h>

#include "app/scenario/message.h"
#include "models/files/regular_file.h"

namespace hvp::scenario {

std::filesystem::path openable_file(const Document& document, std::string_view key,
                                    const std::string& path_in_scenario) {
  std::filesystem::path resolved = document.resolve(key, path_in_scenario);
  try {
    files::require_regular_file(resolved, "a file");
  } catch (const InputError& error) {
    throw SourceError(std::string(key), fmt::format("{}{}: {}", document.locate(key),
                                                    one_line(resolved.string()), error.what()));
  }
  return resolved;
}

void FileVisitor::file(std::string_view name, config::File& file, config::Note) {
  if (!file.empty()) found(joined(path_.back(), key_text(name)), file);
}

bool FileVisitor::begin_effect(std::string_view name, bool& present, const config::EffectNote&) {
  if (present) enter(name);
  return present;
}

bool FileVisitor::begin_list(std::string_view name, std::size_t&, config::Note) {
  enter(name);
  return false;
}

void FileVisitor::begin_item(std::size_t index) {
  path_.push_back(fmt::format("{}[{}]", path_.back(), index));
}

void FileVisitor::enter(std::string_view name) {
  path_.push_back(joined(path_.back(), key_text(name)));
}

void FileResolver::found(const std::string& key, config::File& file) {
  file.path = openable_file(document_, key, file.written).string();
}

}  // namespace hvp::scenario
