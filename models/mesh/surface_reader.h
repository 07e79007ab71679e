#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

enum class SurfaceFormat { stl, ply, obj, vtp, vtu };

// Larger files and surfaces are refused; the figure leaves room for a scan of a million
// triangles in any of the formats.
inline constexpr std::size_t kLargestFile = std::size_t{512} << 20;
inline constexpr int kMostTriangles = 2'000'000;

// The format of a file by its extension (".STL" counts like ".stl"). Throws InputError with the key
// "surface" for any other.
SurfaceFormat format_of(std::string_view extension);

// Throws InputError with the key "surface" for an empty file and for one in VTK's XML that is
// unfinished or declares more than kMostTriangles. It is cheap, and runs before a reader allocates
// the sizes that a header promises.
void precheck(std::string_view bytes, SurfaceFormat format);

// Reads a file, of which `bytes` are the contents: STL, PLY and OBJ as polygon_files.h does, VTP
// and VTU with VTK's readers, which may crash or print on malformed files. Throws InputError with
// the key "surface" and VTK's message, if there is one.
Surface read_contents(const std::string& path, std::string_view bytes, SurfaceFormat format,
                      double unit_m);

// Reads a surface file, STL (text or binary), PLY, OBJ, VTP or VTU by its extension. One unit of
// the file is `unit_m` metres. Polygons are split into triangles, points that single precision
// cannot tell apart at the surface's size are merged, unused points dropped. A VTU's surface is the
// outer surface of its volume cells.
// The triangles keep the file's winding. Only the surface's width and place are checked here (for
// the rest see surface_check.h): the width is within kBodyLength, and the surface is near enough to
// the origin for its coordinates to have digits left.
//
// Throws InputError with the key "surface" and a message that names the file. A file that breaks
// VTK's readers breaks the process: who takes a file from a user calls this in a child process.
Surface read_surface(const std::string& path, double unit_m);

}  // namespace hvp::mesh
