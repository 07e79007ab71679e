#pragma once

#include <string>
#include <string_view>

#include "models/mesh/tet_mesh.h"

// Surfaces as the bytes of files, written here independently of VTK.
namespace hvp::mesh::testing {

std::string as_text_stl(const Surface& surface);
std::string as_binary_stl(const Surface& surface);
std::string as_text_ply(const Surface& surface);
std::string as_binary_ply(const Surface& surface);
std::string as_obj(const Surface& surface);
std::string as_vtp(const Surface& surface);
// Tetrahedra.
std::string as_vtu(const TetMesh& mesh);
// One hexahedron, the unit cube.
std::string cube_as_vtu();

// A file with these bytes that goes away with its name.
class TemporaryFile {
 public:
  TemporaryFile(std::string_view extension, std::string_view bytes);
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile();
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace hvp::mesh::testing
