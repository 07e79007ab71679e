#include "app/mesh/sandboxed_mesh.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <system_error>

#include "app/mesh/byte_stream.h"
#include "app/process/sandbox.h"
#include "models/mesh/generate.h"
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

}  // namespace hvp::app
