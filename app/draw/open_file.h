#pragma once

#include <filesystem>
#include <fstream>

namespace hvp::draw {

// Throws InputError for a file that is missing or not a regular one.
std::ifstream open_file(const std::filesystem::path& path);

}  // namespace hvp::draw
