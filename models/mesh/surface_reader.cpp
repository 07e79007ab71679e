#include "models/mesh/surface_reader.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/files/one_line.h"
#include "models/files/regular_file.h"
#include "models/mesh/mesh_settings.h"

namespace hvp::mesh {

namespace {

std::string contents_of(const std::string& path) {
  try {
    return files::read_regular_file(path, kLargestFile, "a surface file");
  } catch (const InputError& error) {
    throw InputError("surface", fmt::format("{}: {}", path, error.what()));
  }
}

// Coordinates of many files are single precision: of a surface that lies farther from the origin
// than so many times its size, fewer than three digits are left.
constexpr double kFarthest = 1e4;

// Throws InputError for a surface (in metres) that is too far from the origin, too small or too
// large.
void check_place(const Surface& surface, double unit_m) {
  if (surface.points.empty()) return;
  const Eigen::AlignedBox3d box = box_around(surface.points);
  const double width = box.sizes().maxCoeff();
  const double distance = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
  if (distance > kFarthest * width) {
    throw InputError("surface",
                     fmt::format("the surface lies {:.3g} m from the origin and is {:.3g} m "
                                 "wide, which leaves its coordinates too few digits: "
                                 "expected it within {:g} times its width",
                                 distance, width, kFarthest));
  }
  if (width >= kBodyLength.min && width <= kBodyLength.max) return;
  throw InputError("surface",
                   fmt::format("the surface is {:.3g} m wide where one unit of the file is "
                               "{:g} m: expected from {:g} m to {:g} m",
                               width, unit_m, kBodyLength.min, kBodyLength.max));
}

}  // namespace

SurfaceFormat format_of(std::string_view extension) {
  std::string lower(extension);
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (lower == ".stl") return SurfaceFormat::stl;
  if (lower == ".ply") return SurfaceFormat::ply;
  if (lower == ".obj") return SurfaceFormat::obj;
  if (lower == ".vtp") return SurfaceFormat::vtp;
  if (lower == ".vtu") return SurfaceFormat::vtu;
  throw InputError("surface", fmt::format("files ending in \"{}\" are not read; expected .stl, "
                                          ".ply, .obj, .vtp or .vtu",
                                          files::one_line(lower, 40)));
}

Surface read_surface(const std::string& path, double unit_m) {
  const std::string extension = std::filesystem::path(path).extension().string();
  try {
    const std::string contents = contents_of(path);
    const SurfaceFormat format = format_of(extension);
    precheck(contents, format);
    Surface surface = read_contents(path, contents, format, unit_m);
    check_place(surface, unit_m);
    return surface;
  } catch (const InputError& error) {
    const std::string message = error.what();
    if (message.find(path) != std::string::npos) throw;
    throw InputError("surface", fmt::format("{}: {}", path, message));
  }
}

}  // namespace hvp::mesh
