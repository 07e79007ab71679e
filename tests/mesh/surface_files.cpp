#include "tests/mesh/surface_files.h"

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace hvp::mesh::testing {

namespace {

template <class Number>
void put(std::string& bytes, Number value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof value);
}

const Eigen::Vector3d& corner(const Surface& surface, int i) {
  return surface.points[static_cast<std::size_t>(i)];
}

std::string coordinates(const std::vector<Eigen::Vector3d>& points) {
  std::string text;
  for (const auto& x : points) text += fmt::format("{} {} {}\n", x.x(), x.y(), x.z());
  return text;
}

template <std::size_t N>
std::string indices(const std::vector<std::array<int, N>>& cells) {
  std::string text;
  for (const auto& cell : cells) {
    for (const int i : cell) text += fmt::format("{} ", i);
    text += '\n';
  }
  return text;
}

std::string offsets(std::size_t cells, std::size_t corners) {
  std::string text;
  for (std::size_t i = 1; i <= cells; ++i) text += fmt::format("{} ", i * corners);
  return text;
}

std::string vtk_file(std::string_view type, std::string_view body) {
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"{0}\" version=\"0.1\" "
      "byte_order=\"LittleEndian\">\n<{0}>\n{1}</{0}>\n</VTKFile>\n",
      type, body);
}

std::string array(std::string_view type, std::string_view name, std::string_view values) {
  return fmt::format("<DataArray type=\"{}\" Name=\"{}\" format=\"ascii\">\n{}</DataArray>\n", type,
                     name, values);
}

std::string points_element(const std::vector<Eigen::Vector3d>& points) {
  return fmt::format(
      "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n{}"
      "</DataArray></Points>\n",
      coordinates(points));
}

}  // namespace

std::string as_text_stl(const Surface& surface) {
  std::string text = "solid test\n";
  for (const auto& t : surface.triangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int i : t) {
      const auto& x = corner(surface, i);
      text += fmt::format("vertex {} {} {}\n", x.x(), x.y(), x.z());
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid test\n";
}

std::string as_binary_stl(const Surface& surface) {
  std::string bytes(80, ' ');
  put(bytes, static_cast<std::uint32_t>(surface.triangles.size()));
  for (const auto& t : surface.triangles) {
    for (int k = 0; k < 3; ++k) put(bytes, 0.0F);
    for (const int i : t) {
      for (const double value : corner(surface, i)) put(bytes, static_cast<float>(value));
    }
    put(bytes, std::uint16_t{0});
  }
  return bytes;
}

std::string as_text_ply(const Surface& surface) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
      surface.points.size(), surface.triangles.size());
  text += coordinates(surface.points);
  for (const auto& t : surface.triangles) text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  return text;
}

std::string as_binary_ply(const Surface& surface) {
  std::string bytes = as_text_ply(surface);
  bytes.erase(bytes.find("end_header\n") + 11);
  bytes.replace(bytes.find("ascii"), 5, "binary_little_endian");
  for (const auto& x : surface.points) {
    for (const double value : x) put(bytes, static_cast<float>(value));
  }
  for (const auto& t : surface.triangles) {
    put(bytes, std::uint8_t{3});
    for (const int i : t) put(bytes, static_cast<std::int32_t>(i));
  }
  return bytes;
}

std::string as_obj(const Surface& surface) {
  std::string text = "# test\n";
  for (const auto& x : surface.points) text += fmt::format("v {} {} {}\n", x.x(), x.y(), x.z());
  for (const auto& t : surface.triangles) {
    text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
  return text;
}

std::string as_vtp(const Surface& surface) {
  const std::size_t cells = surface.triangles.size();
  return vtk_file(
      "PolyData",
      fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" "
                  "NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n{}<Polys>\n{}{}</Polys>\n</Piece>\n",
                  surface.points.size(), cells, points_element(surface.points),
                  array("Int64", "connectivity", indices(surface.triangles)),
                  array("Int64", "offsets", offsets(cells, 3))));
}

std::string as_vtu(const TetMesh& mesh) {
  const std::size_t cells = mesh.tetrahedra.size();
  std::string types;
  for (std::size_t i = 0; i < cells; ++i) types += "10 ";
  return vtk_file(
      "UnstructuredGrid",
      fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n{}<Cells>\n{}{}{}</Cells>\n"
                  "</Piece>\n",
                  mesh.nodes.size(), cells, points_element(mesh.nodes),
                  array("Int64", "connectivity", indices(mesh.tetrahedra)),
                  array("Int64", "offsets", offsets(cells, 4)), array("UInt8", "types", types)));
}

std::string cube_as_vtu() {
  const std::vector<Eigen::Vector3d> points{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                            {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  return vtk_file(
      "UnstructuredGrid",
      fmt::format("<Piece NumberOfPoints=\"8\" NumberOfCells=\"1\">\n{}<Cells>\n{}{}{}"
                  "</Cells>\n</Piece>\n",
                  points_element(points), array("Int64", "connectivity", "0 1 2 3 4 5 6 7\n"),
                  array("Int64", "offsets", "8\n"), array("UInt8", "types", "12\n")));
}

TemporaryFile::TemporaryFile(std::string_view extension, std::string_view bytes) {
  static int count = 0;
  path_ = (std::filesystem::temp_directory_path() /
           fmt::format("hvp-surface-{}-{}{}", ::getpid(), ++count, extension))
              .string();
  std::ofstream file(path_, std::ios::binary);
  file << bytes;
  EXPECT_TRUE(file.good()) << path_;
}

TemporaryFile::~TemporaryFile() {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

}  // namespace hvp::mesh::testing
