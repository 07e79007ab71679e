#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

// How files of users are read: only where that comes to an end. A pipe may never have
// an end or a beginning, a device neither, and the size of a file is a promise that it may break.
namespace hvp::files {

// Of what a symbolic link leads to. `expected` is what the caller would have liked, such as
// "a scenario". Throws InputError without a key or the file's name: no such file, a folder, a pipe,
// a device, a socket.
void require_regular_file(const std::filesystem::path& file, std::string_view expected);

// All bytes of a regular file. Throws InputError as above, and where it cannot be read or has more
// than `most_bytes`, whatever size it claims.
std::string read_regular_file(const std::filesystem::path& file, std::uintmax_t most_bytes,
                              std::string_view expected);

// A regular file to be read piece by piece. Throws InputError as above.
std::ifstream open_regular_file(const std::filesystem::path& file, std::string_view expected);

}  // namespace hvp::files
