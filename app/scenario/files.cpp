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

void FileResolver::file(std::string_view name, config::File& file, config::Note) {
  if (file.empty()) return;
  file.path = openable_file(document_, joined(path_.back(), key_text(name)), file.written).string();
}

bool FileResolver::begin_effect(std::string_view name, bool& present, const config::EffectNote&) {
  if (present) enter(name);
  return present;
}

bool FileResolver::begin_list(std::string_view name, std::size_t&, config::Note) {
  enter(name);
  return false;
}

void FileResolver::begin_item(std::size_t index) {
  path_.push_back(fmt::format("{}[{}]", path_.back(), index));
}

void FileResolver::enter(std::string_view name) {
  path_.push_back(joined(path_.back(), key_text(name)));
}

}  // namespace hvp::scenario
