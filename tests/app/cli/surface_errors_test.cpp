#include <array>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

namespace hvp::cli::surface_errors_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

using Triangles = std::vector<std::array<std::array<std::string, 3>, 3>>;

std::string stl(const Triangles& triangles) {
  std::string text = "solid body\n";
  for (const auto& triangle : triangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const auto& p : triangle) text += "vertex " + p[0] + " " + p[1] + " " + p[2] + "\n";
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid body\n";
}

// A tetrahedron of 40 mm with its apex at (0, 0, `height`).
Triangles pyramid(const std::string& height) {
  const std::array<std::string, 3> o = {"0", "0", "0"}, x = {"40", "0", "0"}, y = {"0", "40", "0"},
                                   z = {"0", "0", height};
  return {{o, y, x}, {o, x, z}, {x, y, z}, {y, o, z}};
}

Triangles without_last(Triangles triangles) {
  triangles.pop_back();
  return triangles;
}

// A prism whose roof is pulled down through its floor.
Triangles folded() {
  const std::array<std::array<std::string, 3>, 8> p = {{{"0", "0", "0"},
                                                        {"40", "0", "0"},
                                                        {"40", "40", "0"},
                                                        {"0", "40", "0"},
                                                        {"0", "0", "40"},
                                                        {"40", "0", "40"},
                                                        {"40", "40", "40"},
                                                        {"20", "15", "-30"}}};
  const std::array<std::array<std::size_t, 3>, 12> t = {{{0, 2, 1},
                                                         {0, 3, 2},
                                                         {4, 5, 6},
                                                         {4, 6, 7},
                                                         {0, 1, 5},
                                                         {0, 5, 4},
                                                         {1, 2, 6},
                                                         {1, 6, 5},
                                                         {2, 3, 7},
                                                         {2, 7, 6},
                                                         {3, 0, 4},
                                                         {3, 4, 7}}};
  Triangles triangles;
  for (const auto& [a, b, c] : t) triangles.push_back({p[a], p[b], p[c]});
  return triangles;
}

// The small scene with a surface file in place of its box.
std::string scene_with(const std::string& surface) {
  std::string text = kSmallScene;
  const std::string box = "shape = \"box\"\nsize = [\"20 mm\", \"20 mm\", \"20 mm\"]";
  return text.replace(text.find(box), box.size(),
                      "shape = \"surface\"\nsurface = \"" + surface + "\"");
}

struct Broken {
  std::string name;
  std::string text;
  std::string message;

  friend void PrintTo(const Broken& broken, std::ostream* out) { *out << slug(broken.name); }
};

class BrokenSurface : public ::testing::TestWithParam<Broken> {};

TEST_P(BrokenSurface, IsRefusedByRunAndByMesh) {
  const ScratchDirectory place;
  write(place.path() / GetParam().name, GetParam().text);
  write(place.path() / "s.toml", scene_with(GetParam().name));
  const Ended run = hvp(place.path(), {"run", "s.toml", "--out", "out"});
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(lines(run.err).size(), 1U) << run.err;
  EXPECT_THAT(run.err, StartsWith("s.toml:9: object.mesh.surface: "));
  EXPECT_THAT(run.err, HasSubstr(GetParam().message));
  EXPECT_FALSE(std::filesystem::exists(place.path() / "out"));

  const Ended mesh =
      hvp(place.path(), {"mesh", GetParam().name, "--nodes", "60", "--out", "mesh.vtu"});
  EXPECT_EQ(mesh.status, 2);
  EXPECT_EQ(mesh.out, "");
  EXPECT_EQ(lines(mesh.err).size(), 1U) << mesh.err;
  EXPECT_THAT(mesh.err, StartsWith(GetParam().name + ": "));
  EXPECT_THAT(mesh.err, HasSubstr(GetParam().message));
  EXPECT_FALSE(std::filesystem::exists(place.path() / "mesh.vtu"));
}

const std::string kWhole = stl(pyramid("40"));
const std::string kBinary = std::string(80, '\0') + std::string("\x04\0\0\0", 4);

INSTANTIATE_TEST_SUITE_P(
    Surface, BrokenSurface,
    ::testing::Values(Broken{"cut.stl", kWhole.substr(0, kWhole.size() / 2), "it is cut off"},
                      Broken{"binary.stl", kBinary + std::string(120, 'x'), "declares 4 triangles"},
                      Broken{"garbage.stl", "this is a letter and no surface\n", "garbage.stl"},
                      Broken{"empty.stl", "", "the file is empty"},
                      Broken{"nan.stl", stl(pyramid("nan")), "not a finite number"},
                      Broken{"inf.stl", stl(pyramid("inf")), "not a finite number"},
                      Broken{"nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "line 2"},
                      Broken{"letter.doc", "text", "expected .stl, .ply, .obj, .vtp or .vtu"},
                      Broken{"open.stl", stl(without_last(pyramid("40"))), "the surface is open"},
                      Broken{"flat.stl", stl(pyramid("0")), "the surface"},
                      Broken{"pillow.stl",
                             stl({{{{"0", "0", "0"}, {"40", "0", "0"}, {"0", "40", "0"}}},
                                  {{{"0", "0", "0"}, {"0", "40", "0"}, {"40", "0", "0"}}}}),
                             "encloses no volume"},
                      Broken{"folded.stl", stl(folded()), "intersects itself"}));

TEST(Surface, AMissingFileIsNamedWithItsLine) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", scene_with("no.stl"));
  const Ended ended = hvp(place.path(), {"run", "s.toml", "--out", "out"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_EQ(ended.err, "s.toml:9: object.mesh.surface: no.stl: no such file: expected a file\n");
}

// What is refused is repaired as the line says, and then accepted.
TEST(Surface, ARepairIsOfferedAndWorks) {
  const ScratchDirectory place;
  for (const auto& [name, triangles] :
       {std::pair("folded", folded()), std::pair("open", without_last(pyramid("40")))}) {
    const std::string file = std::string(name) + ".stl";
    write(place.path() / file, stl(triangles));
    const Ended refused = hvp(place.path(), {"mesh", file});
    EXPECT_EQ(refused.status, 2);
    EXPECT_THAT(refused.err, HasSubstr("hvp mesh FILE --repair FILE.obj"));
    const Ended repaired = hvp(place.path(), {"mesh", file, "--repair", "out/new.obj"});
    ASSERT_EQ(repaired.status, 0) << repaired.err;
    EXPECT_THAT(repaired.out, HasSubstr("\nmoved "));
    const Ended mesh = hvp(place.path(), {"mesh", "out/new.obj", "--nodes", "300"});
    EXPECT_EQ(mesh.status, 0) << mesh.err;
  }
}

TEST(Surface, ARepairIsRefusedInOneLine) {
  const ScratchDirectory place;
  write(place.path() / "good.stl", stl(pyramid("40")));
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& words) {
    const Ended ended = hvp(place.path(), arguments);
    EXPECT_EQ(ended.status, 2) << words;
    EXPECT_EQ(lines(ended.err).size(), 1U) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(words));
    EXPECT_FALSE(std::filesystem::exists(place.path() / "new.obj"));
  };
  refused({"mesh", "good.stl", "--repair", "new.stl"}, "ends in .obj");
  refused({"mesh", "good.stl", "--repair", "new.obj", "--nodes", "300"},
          "--nodes: a repair makes no tetrahedra");
  refused({"mesh", "good.stl", "--detail", "1 mm"}, "--detail belongs to --repair only");
  refused({"mesh", "good.stl", "--repair", "new.obj", "--detail", "1 um"}, "million points");
  refused({"mesh", "good.stl", "--repair", "new.obj", "--detail", "thin"}, "expected a length");
  refused({"mesh", "good.stl", "--repair", "new.obj", "--out", "a.vtu"}, "expected --repair alone");
  refused({"mesh", "box", "--repair", "new.obj"}, "a surface file only");
  refused({"mesh", "none.stl", "--repair", "new.obj"}, "none.stl: no such file");
  write(place.path() / "flat.stl", stl({pyramid("40").front()}));
  refused({"mesh", "flat.stl", "--repair", "new.obj"}, "enclose nothing");
}

TEST(Surface, EitherWindingIsAccepted) {
  const ScratchDirectory place;
  Triangles inside_out = pyramid("40");
  for (auto& triangle : inside_out) std::swap(triangle[0], triangle[1]);
  write(place.path() / "a.stl", kWhole);
  write(place.path() / "b.stl", stl(inside_out));
  const Ended a = hvp(place.path(), {"mesh", "a.stl", "--nodes", "300"});
  const Ended b = hvp(place.path(), {"mesh", "b.stl", "--nodes", "300"});
  EXPECT_EQ(a.status, 0) << a.err;
  EXPECT_EQ(b.status, 0) << b.err;
  // 40³/6 mm³ both times: a volume of the wrong sign would not pass for a body.
  EXPECT_THAT(a.out, HasSubstr("10.6667 cm3"));
  EXPECT_THAT(b.out, HasSubstr("10.6667 cm3"));
}

}  // namespace
}  // namespace hvp::cli::surface_errors_test
