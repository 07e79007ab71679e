#include "models/mesh/surface_reader.h"

#include <filesystem>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/files/regular_file.h"
#include "models/mesh/byte_stream.h"
#include "models/mesh/child_process.h"
#include "models/mesh/file_precheck.h"
#include "models/mesh/vtk_reading.h"

namespace hvp::mesh {

namespace {

// Text is read at some 10 MB/s.
ChildLimits limits_for(std::size_t file_size) {
  return {.cpu_seconds = 5 + static_cast<int>(file_size >> 20),
          .memory_bytes = std::size_t{4} << 30};
}

std::string contents_of(const std::string& path) {
  try {
    return files::read_regular_file(path, kLargestFile, "a surface file");
  } catch (const InputError& error) {
    throw InputError("surface", fmt::format("{}: {}", path, error.what()));
  }
}

}  // namespace

Surface read_surface(const std::string& path, double unit_m) {
  const std::string extension = std::filesystem::path(path).extension().string();
  try {
    const std::string contents = contents_of(path);
    const SurfaceFormat format = precheck(extension, contents);
    const std::string bytes = run_in_child("the reader", "surface", limits_for(contents.size()), {},
                                           [&](const Progress& /*progress*/) {
                                             const Surface surface =
                                                 read_with_vtk(path, format, unit_m);
                                             ByteWriter writer;
                                             writer.points(surface.points);
                                             writer.tuples(surface.triangles);
                                             return writer.bytes();
                                           });
    ByteReader reader(bytes);
    Surface surface;
    surface.points = reader.points();
    surface.triangles = reader.tuples<3>();
    return surface;
  } catch (const InputError& error) {
    const std::string message = error.what();
    if (message.find(path) != std::string::npos) throw;
    throw InputError("surface", fmt::format("{}: {}", path, message));
  }
}

}  // namespace hvp::mesh
