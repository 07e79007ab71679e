#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace hvp::app {
struct Scenario;
}

namespace hvp::results {

// Creates the folder that results go into, as the command line's `option` names it, with the
// folders above it. Throws InputError where that is impossible: a file has that name, or nothing
// may be written there. Call it before the work whose results would be lost.
void create_folder(const std::filesystem::path& folder, std::string_view option);

// Removes every result file, finished or not, that an earlier run left in the folder, and nothing
// else, so that all result files in a folder are of the last run; those named `but` stay. Throws
// std::runtime_error.
void remove_earlier_results(const std::filesystem::path& folder,
                            const std::vector<std::string>& but = {});

// Locks a results folder for one run; the lock ends with the process, however the process ends.
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

// The text of scenario.resolved.toml. Nothing is written; copied files have the names that they
// would have beside it.
std::string resolved_text(const app::Scenario& scenario, const std::filesystem::path& device);

// Writes scenario.resolved.toml: every parameter with its value, a complete scenario that
// gives the same run again. A surface file is copied to scenario.resolved.stl (or its other
// extension) and a device of the user's own to scenario.resolved.device.toml, because a path would
// tie the results to a place. `device` is the path of the latter; empty for a built-in device.
// Throws std::runtime_error.
void write_resolved_scenario(const std::filesystem::path& directory, const app::Scenario& scenario,
                             const std::filesystem::path& device);

}  // namespace hvp::results
