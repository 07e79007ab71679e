#pragma once

#include <filesystem>

namespace hvp::guest {

// A folder of its own under the system's temporary one, which nobody else may enter; removed with
// what is in it. Throws std::runtime_error where there is none to be had.
class PrivateFolder {
 public:
  PrivateFolder();
  ~PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace hvp::guest
