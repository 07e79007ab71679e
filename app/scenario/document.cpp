#include "app/scenario/document.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/scenario/message.h"
#include "app/scenario/override.h"
#include "app/scenario/syntax.h"

namespace hvp::scenario {
namespace {

constexpr std::size_t kLargestFile = 1U << 20U;
constexpr std::size_t kLongestName = 1000;

std::string name_of(const std::filesystem::path& file) {
  return one_line(file.string(), kLongestName);
}

// Owns a file descriptor.
class File {
 public:
  explicit File(const char* name) : descriptor_(::open(name, O_RDONLY | O_CLOEXEC)) {}
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

[[noreturn]] void fail_to_read(const std::filesystem::path& file, int error) {
  if (error == ENOENT || error == ENOTDIR) {
    throw SourceError(fmt::format("{}: no such file: expected a scenario", name_of(file)));
  }
  throw SourceError(fmt::format("{}: cannot be read: {}", name_of(file), std::strerror(error)));
}

// Reads in pieces up to the limit, since a pipe or a device has no size to ask for.
std::string read_text(const std::filesystem::path& file) {
  const File source(file.c_str());
  if (source.descriptor() < 0) fail_to_read(file, errno);
  struct stat status {};
  if (::fstat(source.descriptor(), &status) == 0 && S_ISDIR(status.st_mode)) {
    throw SourceError(fmt::format("{}: is a directory: expected a scenario", name_of(file)));
  }
  std::string text;
  std::array<char, 65536> piece{};
  while (true) {
    const ssize_t count = ::read(source.descriptor(), piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail_to_read(file, errno);
    if (count == 0) return text;
    text.append(piece.data(), static_cast<std::size_t>(count));
    if (text.size() > kLargestFile) {
      throw SourceError(fmt::format("{}: is too large: expected at most 1 MiB", name_of(file)));
    }
  }
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
    if (equals == std::string::npos || equals == 0) {
      throw InputError("expected KEY=VALUE, such as object.mesh.nodes=300");
    }
    if (text.size() > kLargestFile) throw InputError("is too large");
    overrides_.push_back({text.substr(0, equals), text});
    put(root_, text.substr(0, equals), override_value(text.substr(equals + 1), index));
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
