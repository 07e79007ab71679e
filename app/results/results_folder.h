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

}  // namespace hvp::results
