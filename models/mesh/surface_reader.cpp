#include "models/mesh/surface_reader.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "models/config/input_error.h"
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
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    throw InputError("surface", fmt::format("there is no file {}", path));
  }
  if (!std::filesystem::is_regular_file(status)) {
    throw InputError("surface", fmt::format("{} is not a regular file", path));
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!error && size > kLargestFile) {
    throw InputError("surface", fmt::format("{}: the file has {} bytes; at most {} are read", path,
                                            size, kLargestFile));
  }
  std::ifstream file(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!file.good() && !file.eof()) {
    throw InputError("surface", fmt::format("{} cannot be read: {}", path, std::strerror(errno)));
  }
  return bytes;
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
