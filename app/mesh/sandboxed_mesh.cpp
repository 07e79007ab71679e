#include "app/mesh/sandboxed_mesh.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "app/mesh/byte_stream.h"
#include "app/process/sandbox.h"
#include "models/config/input_error.h"
#include "models/mesh/generate.h"
#include "models/mesh/surface_check.h"
#include "models/mesh/surface_reader.h"

namespace hvp::app {

namespace {

// Text is read at some 10 MB/s.
SandboxLimits limits_of_file(const std::string& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  const bool read = !error && size <= mesh::kLargestFile;  // the reader refuses any other
  return {.cpu_seconds = 5 + (read ? static_cast<int>(size >> 20) : 0),
          .memory_bytes = std::size_t{4} << 30};
}

// A mesh of a million nodes takes TetGen a minute or two, and a search needs a few.
SandboxLimits limits_of_nodes(int nodes) {
  return {.cpu_seconds = 60 + nodes / 1000, .memory_bytes = std::size_t{8} << 30};
}

// What a surface of a file lacks, another file can have.
constexpr const char* kRepair =
    "; hvp mesh FILE --repair FILE.obj makes a closed surface of one body";

template <class Work>
mesh::TetMesh mesh_in_child(int wanted, const Progress& progress, const Work& work) {
  const std::string bytes = run_in_sandbox("the mesher", "surface", limits_of_nodes(wanted),
                                           progress, [&](const Progress& inner) {
                                             const mesh::TetMesh mesh = work(inner);
                                             ByteWriter writer;
                                             writer.points(mesh.nodes);
                                             writer.tuples(mesh.tetrahedra);
                                             writer.tuples(mesh.mid_edge);
                                             writer.tuples(mesh.boundary);
                                             return writer.bytes();
                                           });
  ByteReader reader(bytes);
  mesh::TetMesh mesh;
  mesh.nodes = reader.points();
  mesh.tetrahedra = reader.tuples<4>();
  mesh.mid_edge = reader.tuples<6>();
  mesh.boundary = reader.tuples<3>();
  return mesh;
}

}  // namespace

mesh::TetMesh sandboxed_mesh(const mesh::MeshSettings& settings, const Progress& progress) {
  settings.check();
  if (settings.shape != mesh::MeshSettings::Shape::surface) {
    return mesh_in_child(settings.nodes, progress,
                         [&](const Progress& inner) { return mesh::generate(settings, inner); });
  }
  if (progress) progress("reading the surface");
  const mesh::Surface surface = sandboxed_surface(settings.surface.path, settings.surface_unit);
  return mesh_in_child(settings.nodes, progress, [&](const Progress& inner) {
    try {
      mesh::check_surface(surface);
    } catch (const InputError& e) {
      throw InputError(e.key(), e.what() + std::string(kRepair));
    }
    return mesh::tetrahedralise(surface, settings.nodes, inner, settings.quadratic);
  });
}

mesh::Surface sandboxed_surface(const std::string& path, double unit_m) {
  const std::string bytes = run_in_sandbox(path + ": the reader", "surface", limits_of_file(path),
                                           {}, [&](const Progress& /*progress*/) {
                                             const mesh::Surface surface =
                                                 mesh::read_surface(path, unit_m);
                                             ByteWriter writer;
                                             writer.points(surface.points);
                                             writer.tuples(surface.triangles);
                                             return writer.bytes();
                                           });
  ByteReader reader(bytes);
  mesh::Surface surface;
  surface.points = reader.points();
  surface.triangles = reader.tuples<3>();
  return surface;
}

namespace {

// As a file has it.
mesh::Surface in_single_precision(mesh::Surface surface, double unit_m) {
  for (Eigen::Vector3d& x : surface.points) {
    x = (x / unit_m).cast<float>().cast<double>() * unit_m;
  }
  return surface;
}

}  // namespace

mesh::RepairedSurface sandboxed_repair(const std::string& path, double unit_m, double detail_m,
                                       const Progress& progress) {
  if (progress) progress("reading the surface");
  const mesh::Surface raw = sandboxed_surface(path, unit_m);
  // Winding numbers of a million triangles take a minute a thousand points.
  const SandboxLimits limits{.cpu_seconds = 1800, .memory_bytes = std::size_t{8} << 30};
  const std::string bytes =
      run_in_sandbox("the repair", "surface", limits, progress, [&](const Progress& inner) {
        mesh::RepairedSurface repaired = mesh::repair_surface(raw, detail_m, inner);
        repaired.surface = in_single_precision(std::move(repaired.surface), unit_m);
        mesh::check_surface(repaired.surface);
        ByteWriter writer;
        writer.points(repaired.surface.points);
        writer.tuples(repaired.surface.triangles);
        writer.points({{repaired.detail, repaired.moved, repaired.left_share},
                       {repaired.volume, repaired.dropped_volume,
                        static_cast<double>(repaired.dropped_shells)},
                       {repaired.old_volume.value_or(-1), 0, 0}});
        return writer.bytes();
      });
  ByteReader reader(bytes);
  mesh::RepairedSurface repaired;
  repaired.surface.points = reader.points();
  repaired.surface.triangles = reader.tuples<3>();
  const std::vector<Eigen::Vector3d> figures = reader.points();
  repaired.detail = figures.at(0)[0];
  repaired.moved = figures.at(0)[1];
  repaired.left_share = figures.at(0)[2];
  repaired.volume = figures.at(1)[0];
  repaired.dropped_volume = figures.at(1)[1];
  repaired.dropped_shells = static_cast<int>(figures.at(1)[2]);
  if (figures.at(2)[0] >= 0) repaired.old_volume = figures.at(2)[0];
  return repaired;
}

}  // namespace hvp::app
