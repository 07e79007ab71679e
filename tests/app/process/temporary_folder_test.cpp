#include "app/process/temporary_folder.h"

#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hvp::app::temporary_folder_test {
namespace {

namespace fs = std::filesystem;
using ::testing::StartsWith;

TEST(TemporaryFolder, IsItsOwnersAloneAndGoesWithAllThatIsInIt) {
  fs::path path;
  {
    const TemporaryFolder folder("hvp-of-a-test");
    path = folder.path();
    EXPECT_EQ(path.parent_path(), fs::temp_directory_path());
    EXPECT_THAT(path.filename().string(), StartsWith("hvp-of-a-test-"));
    EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_all);
    fs::create_directories(path / "a" / "b");
    std::ofstream(path / "a" / "b" / "file") << "text";
    EXPECT_NE(TemporaryFolder("hvp-of-a-test").path(), path);
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST(TemporaryFolder, SaysWhyThereIsNone) {
  const char* before = std::getenv("TMPDIR");
  const std::string kept = before == nullptr ? "" : before;
  ::setenv("TMPDIR", "/no/such/folder", 1);
  std::string message;
  try {
    const TemporaryFolder folder;
  } catch (const std::runtime_error& error) {
    message = error.what();
  }
  kept.empty() ? ::unsetenv("TMPDIR") : ::setenv("TMPDIR", kept.c_str(), 1);
  EXPECT_EQ(message, "no folder for temporary files: No such file or directory");
}

}  // namespace
}  // namespace hvp::app::temporary_folder_test
