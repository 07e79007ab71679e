#include "app/scenario/files.h"

#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "app/scenario/message.h"

namespace hvp::scenario {

std::filesystem::path openable_file(const Document& document, std::string_view key,
                                    const std::string& path_in_scenario) {
  std::filesystem::path resolved = document.resolve(path_in_scenario);
  std::error_code error;
  const auto status = std::filesystem::status(resolved, error);
  const std::string shown = one_line(resolved.string());
  const std::string place = document.locate(key);
  if (!std::filesystem::exists(status)) {
    throw SourceError(fmt::format("{}no such file: {}", place, shown));
  }
  if (std::filesystem::is_directory(status)) {
    throw SourceError(fmt::format("{}expected a file, found the directory {}", place, shown));
  }
  return resolved;
}

void FileResolver::file(std::string_view name, std::string& path, config::Note) {
  if (path.empty()) return;
  path = openable_file(document_, joined(path_.back(), key_text(name)), path).string();
}

bool FileResolver::begin_effect(std::string_view name, bool& present, config::Note) {
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
