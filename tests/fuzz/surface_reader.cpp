// The surface reader on arbitrary bytes. The first byte, a digit, says which extension the file
// has; the rest is the file. What must hold: the reader throws nothing but an InputError of one
// line that blames the surface, and what it accepts and the check passes is the closed surface
// of a body with a volume. A crash inside VTK happens in a child process and is such an
// InputError; a crash on this side of the pipe is a finding.
#include "models/mesh/surface_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <unistd.h>

#include "app/mesh/sandboxed_mesh.h"
#include "models/config/input_error.h"
#include "models/mesh/polygon_files.h"
#include "models/mesh/surface_check.h"

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

// The bytes as a file for as long as the object lives.
class File {
 public:
  File(std::string_view extension, std::string_view bytes)
      : path_((std::filesystem::temp_directory_path() /
               fmt::format("hvp-fuzz-{}{}", ::getpid(), extension))
                  .string()) {
    std::ofstream(path_, std::ios::binary) << bytes;
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array<std::string_view, 5> kExtensions{".stl", ".ply", ".obj", ".vtp", ".vtu"};
  if (size == 0) return 0;
  const std::string_view extension = kExtensions[data[0] % kExtensions.size()];
  const std::string bytes(data + 1, data + size);
  try {
    // Before a file is written and a process forked, and in this process for the texts.
    const hvp::mesh::SurfaceFormat format = hvp::mesh::format_of(extension);
    hvp::mesh::precheck(bytes, format);
    if (format == hvp::mesh::SurfaceFormat::stl) hvp::mesh::read_stl(bytes);
    if (format == hvp::mesh::SurfaceFormat::ply) hvp::mesh::read_ply(bytes);
    if (format == hvp::mesh::SurfaceFormat::obj) hvp::mesh::read_obj(bytes);
    const File file(extension, bytes);
    const hvp::mesh::Surface surface =
        hvp::mesh::check_surface(hvp::app::sandboxed_surface(file.path(), 1e-3));
    require(surface.triangles.size() >= 4);
    const double volume = hvp::mesh::enclosed_volume(surface);
    require(std::isfinite(volume) && volume > 0.0);
  } catch (const hvp::InputError& error) {
    const std::string_view line = error.what();
    require(error.key() == "surface");
    require(!line.empty() && line.size() < 2000);
    require(std::none_of(line.begin(), line.end(), [](char c) { return c == '\n' || c == '\0'; }));
  }
  return 0;
}
