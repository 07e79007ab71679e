#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

// Reads users' files, but only those whose reading comes to an end. A pipe may have no end or
// beginning, nor may a device, and the stated size of a file may be wrong.
namespace hvp::files {

// Requires a regular file, or a symbolic link to one. `expected` is what the caller expected, such
// as "a scenario". Throws InputError without a key or the file's name: no such file, a folder, a
// pipe, a device, a socket.
void require_regular_file(const std::filesystem::path& file, std::string_view expected);

// Returns all bytes of a regular file. Throws InputError as above, and where it cannot be read or
// has more than `most_bytes`, whatever size it claims.
std::string read_regular_file(const std::filesystem::path& file, std::uintmax_t most_bytes,
                              std::string_view expected);

// Opens a regular file, to be read piece by piece. Throws InputError as above.
std::ifstream open_regular_file(const std::filesystem::path& file, std::string_view expected);

}  // namespace hvp::files
