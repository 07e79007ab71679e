#pragma once

#include <string>
#include <string_view>

namespace hvp::mesh {

enum class SurfaceFormat { stl_text, stl_binary, ply, obj, vtp, vtu };

// Larger files and surfaces are refused; the figure leaves room for a scan of a million
// triangles in any of the formats.
inline constexpr std::size_t kLargestFile = std::size_t{512} << 20;
inline constexpr int kMostTriangles = 2'000'000;

// What a file holds by its extension (".STL" counts like ".stl") and its bytes. Throws
// InputError with the key "surface" where the bytes contradict themselves: empty, of no known
// format, fewer bytes or lines than its header declares, an unfinished text or XML file, more
// than kMostTriangles. Cheap, and runs before a reader allocates what a header promises.
SurfaceFormat precheck(std::string_view extension, std::string_view bytes);

}  // namespace hvp::mesh
