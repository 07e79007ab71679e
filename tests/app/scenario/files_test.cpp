#include "app/scenario/files.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "app/scenario/writer.h"
#include "tests/app/scenario/read_toy.h"

namespace hvp::scenario::files_test {
namespace {

TEST(FileParameters, StartFromTheScenariosFolder) {
  const Document document = Document::parse("a = 1", "scenes/deep/x.toml");
  EXPECT_EQ(document.resolve("surface", "body.stl"), "scenes/deep/body.stl");
  EXPECT_EQ(document.resolve("surface", "/opt/body.stl"), "/opt/body.stl");
  EXPECT_EQ(Document::parse("a = 1", "x.toml").resolve("surface", "body.stl"), "body.stl");
}

// What stands on the command line is a path of the caller's folder.
TEST(FileParameters, OfAnOverrideStartFromTheWorkingFolder) {
  const std::string here = "hvp-files-test-" + std::to_string(::getpid()) + ".csv";
  std::ofstream(std::filesystem::current_path() / here) << "1";
  const Document document = Document::parse("a = 1", "scenes/x.toml", {"surface=" + here});
  EXPECT_EQ(document.resolve("surface", here), here);
  EXPECT_EQ(document.resolve("surface", "not-here.csv"), "scenes/not-here.csv");
  std::filesystem::remove(here);
}

TEST(FileParameters, AreResolvedAfterTheyAreWritten) {
  const auto folder = std::filesystem::temp_directory_path();
  const std::string name = "hvp-files-test-" + std::to_string(::getpid()) + ".stl";
  std::ofstream(folder / name) << "solid";
  const Document document =
      Document::parse("title = 'x'\n[object]\nsurface = '" + name + "'", folder / "x.toml");
  toy::Scene scene;
  read(document, scene);
  EXPECT_EQ(scene.object.surface.written, name);
  EXPECT_EQ(resolved(scene).find(folder.string()), std::string::npos);
  resolve_files(document, scene);
  EXPECT_EQ(scene.object.surface.path, (folder / name).string());
  EXPECT_EQ(scene.object.surface.written, name);
  std::filesystem::remove(folder / name);
}

TEST(FileParameters, ThatAreMissingAreReported) {
  const auto error = [](const std::string& surface) -> std::string {
    const Document document =
        Document::parse("title = 'x'\n[object]\nsurface = '" + surface + "'", "/nowhere/x.toml");
    toy::Scene scene;
    read(document, scene);
    try {
      resolve_files(document, scene);
    } catch (const SourceError& failure) {
      return failure.what();
    }
    return "no error";
  };
  EXPECT_EQ(error("body.stl"),
            "/nowhere/x.toml:3: object.surface: /nowhere/body.stl: no such file: expected a file");
  EXPECT_EQ(error("/"), "/nowhere/x.toml:3: object.surface: /: is a folder: expected a file");
  EXPECT_EQ(error(""), "no error");
}

}  // namespace
}  // namespace hvp::scenario::files_test
