#include "models/mesh/surface_reader.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <ostream>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/mesh/sandboxed_mesh.h"
#include "models/mesh/generate.h"
#include "models/mesh/parametric_surface.h"
#include "models/mesh/surface_check.h"
#include "tests/mesh/surface_files.h"
#include "tests/mesh/surfaces.h"

namespace hvp::mesh::surface_reader_test {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::refusal;
using testing::TemporaryFile;
using testing::unit_cube;

Surface read(std::string_view extension, std::string_view bytes, double unit_m = 1.0) {
  const TemporaryFile file(extension, bytes);
  return app::sandboxed_surface(file.path(), unit_m);
}

std::string reason(std::string_view extension, std::string_view bytes, double unit_m = 1.0) {
  const TemporaryFile file(extension, bytes);
  const std::string message =
      refusal("surface", [&] { check_surface(app::sandboxed_surface(file.path(), unit_m)); });
  return message;
}

struct Format {
  std::string name;
  std::string extension;
  std::function<std::string(const Surface&)> write;
};
std::ostream& operator<<(std::ostream& out, const Format& format) { return out << format.name; }

std::vector<Format> formats() {
  return {
      {"text_stl", ".stl", testing::as_text_stl}, {"binary_stl", ".stl", testing::as_binary_stl},
      {"text_ply", ".ply", testing::as_text_ply}, {"binary_ply", ".ply", testing::as_binary_ply},
      {"obj", ".obj", testing::as_obj},           {"vtp", ".vtp", testing::as_vtp}};
}

class EveryFormat : public ::testing::TestWithParam<Format> {};
INSTANTIATE_TEST_SUITE_P(ReadSurface, EveryFormat, ::testing::ValuesIn(formats()),
                         [](const auto& format) { return format.param.name; });

TEST_P(EveryFormat, GivesTheSurfaceBack) {
  const Surface sphere = sphere_surface(1.0, 40);
  const Surface got = check_surface(read(GetParam().extension, GetParam().write(sphere), 1e-3));
  EXPECT_EQ(got.points.size(), 40U);
  EXPECT_EQ(got.triangles.size(), 76U);
  // Coordinates are single precision in most of the formats.
  EXPECT_NEAR(enclosed_volume(got), 1e-9 * enclosed_volume(sphere), 1e-15);
}

TEST_P(EveryFormat, UpperCaseExtensionsCount) {
  std::string extension = GetParam().extension;
  for (char& c : extension) c = static_cast<char>(std::toupper(c));
  EXPECT_EQ(read(extension, GetParam().write(unit_cube())).triangles.size(), 12U);
}

// Every file that is cut off somewhere is refused; none is taken for the whole surface.
TEST_P(EveryFormat, CutOffIsRefused) {
  const std::string whole = GetParam().write(unit_cube());
  for (std::size_t tenth = 0; tenth < 10; ++tenth) {
    reason(GetParam().extension, whole.substr(0, tenth * whole.size() / 10));
  }
}

TEST_P(EveryFormat, NoSurfaceAtAllIsRefused) { reason(GetParam().extension, "hello\n"); }

TEST_P(EveryFormat, CoordinatesBeyondAllBoundsAreRefused) {
  Surface surface = unit_cube();
  for (const double bad : {std::numeric_limits<double>::infinity(), std::nan("")}) {
    surface.points[6].x() = bad;
    const std::string message = reason(GetParam().extension, GetParam().write(surface));
    EXPECT_THAT(message, AnyOf(HasSubstr("not a finite number"), HasSubstr("VTK's reader"),
                               HasSubstr("open")));
  }
}

TEST(ReadSurface, TakesTheOuterSurfaceOfTetrahedra) {
  const TetMesh ball = generate({.nodes = 150});
  const Surface surface = check_surface(read(".vtu", testing::as_vtu(ball)));
  EXPECT_EQ(surface.triangles.size(), ball.boundary.size());
  EXPECT_NEAR(enclosed_volume(surface), testing::volume_from_boundary(ball), 1e-12);
}

TEST(ReadSurface, TakesTheOuterSurfaceOfHexahedra) {
  const Surface surface = read(".vtu", testing::cube_as_vtu());
  EXPECT_EQ(surface.triangles.size(), 12U);
  EXPECT_DOUBLE_EQ(enclosed_volume(surface), 1.0) << "VTK winds faces outward";
}

TEST(ReadSurface, SplitsPolygons) {
  const std::string obj =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
      "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  EXPECT_DOUBLE_EQ(enclosed_volume(check_surface(read(".obj", obj))), 1.0);
}

TEST(ReadSurface, ABinaryStlMayStartWithSolid) {
  std::string bytes = testing::as_binary_stl(unit_cube());
  bytes.replace(0, 5, "solid");
  EXPECT_EQ(read(".stl", bytes).triangles.size(), 12U);
}

// As some programs write it: all in one line, or with bytes behind the last triangle.
TEST(ReadSurface, StlIsReadAsViewersDo) {
  std::string line = testing::as_text_stl(unit_cube());
  std::ranges::replace(line, '\n', ' ');
  EXPECT_DOUBLE_EQ(enclosed_volume(check_surface(read(".stl", line))), 1.0);
  const std::string longer = testing::as_binary_stl(unit_cube()) + "ab";
  EXPECT_DOUBLE_EQ(enclosed_volume(check_surface(read(".stl", longer))), 1.0);
}

// Some CAD programs write SOLID, FACET NORMAL and VERTEX.
TEST(ReadSurface, TextStlMayBeInCapitals) {
  std::string capitals = testing::as_text_stl(unit_cube());
  for (char& c : capitals) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  ASSERT_THAT(capitals, HasSubstr("ENDSOLID"));
  const Surface surface = check_surface(read(".stl", capitals));
  EXPECT_EQ(surface.triangles.size(), 12U);
  EXPECT_DOUBLE_EQ(enclosed_volume(surface), 1.0);
  EXPECT_THAT(reason(".stl", capitals.substr(0, capitals.find("ENDSOLID"))), HasSubstr("cut off"));
}

// Far away, the points of an STL file, which are single precision, move on a grid of their own: at
// 1e9 widths from the origin they coincide, and the surface would be blamed.
TEST(ReadSurface, ASurfaceFarFromTheOriginIsRefused) {
  const auto at = [](double distance) {
    Surface surface = unit_cube();
    for (Eigen::Vector3d& x : surface.points) x.y() += distance;
    return testing::as_text_stl(surface);
  };
  EXPECT_EQ(read(".stl", at(-9000)).triangles.size(), 12U);
  for (const double distance : {1.1e4, -1.1e4, 1e6, 1e9, 1e12}) {
    EXPECT_THAT(reason(".stl", at(distance)), HasSubstr("m from the origin")) << distance;
  }
}

TEST(ReadSurface, ASurfaceOfNoImaginableSizeIsRefused) {
  const std::string cube = testing::as_text_stl(unit_cube());
  for (const double unit : {1e-6, 1.0, 1e3}) EXPECT_EQ(read(".stl", cube, unit).points.size(), 8U);
  EXPECT_THAT(reason(".stl", cube, 0.9e-6),
              HasSubstr("the surface is 9e-07 m wide where one unit"));
  EXPECT_THAT(reason(".stl", cube, 1.1e3), HasSubstr("expected from 1e-06 m to 1000 m"));
  Surface huge = unit_cube();
  for (Eigen::Vector3d& x : huge.points) x *= 1e200;
  EXPECT_THAT(reason(".stl", testing::as_text_stl(huge)), HasSubstr("3.4e38 of single precision"));
}

TEST(ReadSurface, SaysWhatIsWrongWithTheFile) {
  EXPECT_THAT(refusal("surface", [] { app::sandboxed_surface("/nowhere/a.stl", 1.0); }),
              HasSubstr("/nowhere/a.stl: no such file: expected a surface file"));
  EXPECT_THAT(refusal("surface",
                      [] { app::sandboxed_surface(std::filesystem::temp_directory_path(), 1.0); }),
              HasSubstr("is a folder: expected a surface file"));
  EXPECT_THAT(reason(".stl", ""), HasSubstr("the file is empty"));
  EXPECT_THAT(reason(".step", "ISO-10303-21;"), HasSubstr("expected .stl, .ply, .obj, .vtp"));
  EXPECT_THAT(reason(".stl", "solid a\nendsolid a\n"), HasSubstr("holds no triangles"));
  EXPECT_THAT(
      reason(".ply", "ply\nformat ascii 1.0\nelement vertex 0\nelement face 0\nend_header\n"),
      HasSubstr("0 vertices and 0 faces"));
}

TEST(ReadSurface, CountsBeyondTheFileAreRefusedBeforeTheyAreAllocated) {
  std::string stl = testing::as_binary_stl(unit_cube());
  const std::uint32_t huge = 0xFFFFFFFF;
  std::memcpy(stl.data() + 80, &huge, sizeof huge);
  EXPECT_THAT(reason(".stl", stl), HasSubstr("declares 4294967295 triangles, which take"));

  std::string ply = testing::as_binary_ply(unit_cube());
  ply.replace(ply.find("vertex 8"), 8, "vertex 4000000");
  EXPECT_THAT(reason(".ply", ply), HasSubstr("declares items of "));
  ply.replace(ply.find("vertex 4000000"), 14, "vertex 99999999999999999999");
  EXPECT_THAT(reason(".ply", ply), HasSubstr("count that is no number"));

  std::string vtp = testing::as_vtp(unit_cube());
  vtp.replace(vtp.find("NumberOfPoints=\"8\""), 18, "NumberOfPoints=\"900000000000\"");
  EXPECT_THAT(reason(".vtp", vtp), HasSubstr("declares NumberOfPoints = 900000000000"));
}

TEST(ReadSurface, IndicesBeyondThePointsAreRefused) {
  Surface surface = unit_cube();
  surface.triangles[5][1] = 88;
  for (const auto& format : formats()) {
    if (format.extension == ".stl") continue;  // has no indices
    EXPECT_THAT(reason(format.extension, format.write(surface)),
                AnyOf(HasSubstr("88"), HasSubstr("89"), HasSubstr("the reader crashed"),
                      HasSubstr("VTK's reader")))
        << format.name;
  }
  surface.triangles[5][1] = -2000000000;
  reason(".vtp", testing::as_vtp(surface));
  reason(".ply", testing::as_binary_ply(surface));
}

TEST(ReadSurface, NamesTheFile) {
  const TemporaryFile file(".stl", "solid\n");
  EXPECT_THAT(refusal("surface", [&] { app::sandboxed_surface(file.path(), 1.0); }),
              HasSubstr(file.path()));
}

TEST(ReadSurface, QuadraticCellsAreRefused) {
  std::string vtu = testing::cube_as_vtu();
  vtu.replace(vtu.find("\n12\n"), 4, "\n25\n");
  EXPECT_THAT(reason(".vtu", vtu), HasSubstr("cells of VTK type 25"));
}

TEST(ReadSurface, ACellWithTooFewCornersIsRefused) {
  std::string vtu = testing::cube_as_vtu();
  vtu.replace(vtu.find("\n8\n"), 3, "\n5\n");
  reason(".vtu", vtu);
}

TEST(ReadSurface, NothingReachesTheTerminal) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  std::string vtp = testing::as_vtp(unit_cube());
  vtp.replace(vtp.find("</Points>"), 9, "</Pints>>");
  const std::string message = reason(".vtp", vtp);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_THAT(message, HasSubstr("VTK's reader refuses the file: "));
  EXPECT_THAT(message, Not(HasSubstr("0x")));
}

}  // namespace
}  // namespace hvp::mesh::surface_reader_test
