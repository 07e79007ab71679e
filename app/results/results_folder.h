#pragma once

#include <filesystem>
#include <string_view>

namespace hvp::results {

// Creates the folder that results go into, as the command line's `option` names it, with the
// folders above it. Throws InputError where that cannot be: a file stands in its place, or
// nothing may be written there. To be called before the work whose results would be lost.
void create_folder(const std::filesystem::path& folder, std::string_view option);

// Removes every result file that an earlier run left in the folder, finished or not, and nothing
// else: what stands in a folder after a run is of that run. Throws std::runtime_error.
void remove_earlier_results(const std::filesystem::path& folder);

// Holds a results folder for one run; it is free again when the process ends, however it does.
class FolderLock {
 public:
  // Throws InputError where another run is writing into the folder.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace hvp::results
