#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace hvp::results {

// The name of a file that is being written, from before it is made until it has its final name or
// is removed: a signal that ends the program takes it away, so that none is left.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(const std::filesystem::path& path);
  ~UnfinishedFile();
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

  // Removes those that there are. May be called by a signal handler.
  static void remove_all() noexcept;

 private:
  std::filesystem::path path_;
  std::size_t slot_;
};

}  // namespace hvp::results
