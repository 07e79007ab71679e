#pragma once

#include <filesystem>
#include <string_view>

namespace hvp::results {

// "<path>.part", which is not there now: what a file is called until it is whole.
std::filesystem::path part_of(const std::filesystem::path& path);

// Writes `bytes` to "<path>.part" and renames that to `path`, so that a run that is killed or a
// disk that is full leaves no half file under the final name. Throws std::runtime_error naming
// the file and the cause, after removing the part file.
void write_through_part_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace hvp::results
