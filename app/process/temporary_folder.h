#pragma once

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

namespace hvp::app {

// A new folder among the temporary files, removed with all that is in it. No other user can read
// it: mkdtemp() creates it with mode 0700 (POSIX).
class TemporaryFolder {
 public:
  // Its name begins with `prefix` and a hyphen. Throws std::runtime_error where none can be made.
  explicit TemporaryFolder(std::string_view prefix = "hvp") {
    std::error_code error;
    std::string name =
        (std::filesystem::temp_directory_path(error) / (std::string(prefix) + "-XXXXXX")).string();
    if (!error && ::mkdtemp(name.data()) == nullptr) error = {errno, std::generic_category()};
    if (error) throw std::runtime_error("no folder for temporary files: " + error.message());
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace hvp::app
