#include <string>

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// Whatever a command reads, it reads regular files only: a pipe or a device in the place of one may
// never end. A command that waits for one runs into ctest's time limit.
namespace hvp::cli::file_kinds_test {
namespace {

using ::testing::HasSubstr;

// What stands before the name of the odd file.
struct Reader {
  const char* what;
  std::vector<std::string> arguments;  // FILE is replaced
  const char* expected;

  friend void PrintTo(const Reader& reader, std::ostream* out) { *out << slug(reader.what); }
};

class FileKinds : public ::testing::TestWithParam<Reader> {
 protected:
  void SetUp() override {
    std::string scene = kSmallScene;
    write(place_.path() / "s.toml", scene);
    write(place_.path() / "b.mtx", "%%MatrixMarket matrix array real general\n3 1\n1\n1\n1\n");
    write(place_.path() / "A.mtx",
          "%%MatrixMarket matrix coordinate real general\n3 3 3\n1 1 1\n2 2 1\n3 3 1\n");
  }

  Ended with(const std::string& file) {
    std::vector<std::string> arguments = GetParam().arguments;
    for (std::string& argument : arguments) {
      const std::size_t at = argument.find("FILE");
      if (at != std::string::npos) argument.replace(at, 4, file);
    }
    return hvp(place_.path(), arguments);
  }

  void expect_refused(const std::string& file, const std::string& kind) {
    const Ended ended = with(file);
    EXPECT_EQ(ended.status, 2) << ended.err;
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(lines(ended.err).size(), 1U) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(kind + ": expected " + GetParam().expected));
  }

  ScratchDirectory place_;
};

TEST_P(FileKinds, OnlyRegularFilesAreRead) {
  const std::string ending =
      GetParam().expected == std::string("a surface file") ? ".stl" : ".toml";
  const std::string pipe = (place_.path() / ("pipe" + ending)).string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::filesystem::create_symlink(pipe, place_.path() / ("link" + ending));
  std::filesystem::create_symlink("/dev/zero", place_.path() / ("zero" + ending));
  std::filesystem::create_directory(place_.path() / ("folder" + ending));
  expect_refused("pipe" + ending, "is a pipe");
  expect_refused("link" + ending, "is a pipe");
  expect_refused("zero" + ending, "is a device");
  expect_refused("folder" + ending, "is a folder");
  expect_refused("none" + ending, "no such file");
}

INSTANTIATE_TEST_SUITE_P(
    Every, FileKinds,
    ::testing::Values(
        Reader{"run", {"run", "FILE"}, "a scenario"},
        Reader{"explain", {"explain", "FILE"}, "a scenario"},
        Reader{"export", {"export", "FILE", "--out", "out"}, "a scenario"},
        Reader{"device", {"device", "FILE"}, "a scenario"},
        Reader{"surface of a scenario",
               {"run", "s.toml", "--set", "object.mesh={shape='surface', surface='FILE'}"},
               "a file"},
        Reader{"device of a scenario",
               {"run", "s.toml", "--set", "accelerator.device=FILE"},
               "a file"},
        Reader{"samples of a scenario",
               {"run", "s.toml", "--set", "host.jitter={distribution='measured', samples='FILE'}"},
               "a file"},
        Reader{"samples of reads",
               {"run", "s.toml", "--set",
                "bus.read_latencies={distribution='measured', samples='FILE'}"},
               "a file"},
        Reader{"samples of a link",
               {"run", "s.toml", "--set", "transfer.method=dma", "--set",
                "bus.pcie.root_complex_latencies={distribution='measured', samples='FILE'}"},
               "a file"},
        Reader{"device of solve",
               {"solve", "--matrix", "A.mtx", "--rhs", "b.mtx", "--set", "accelerator.device=FILE"},
               "a file"},
        Reader{"surface of mesh", {"mesh", "FILE"}, "a surface file"},
        Reader{"matrix", {"solve", "--matrix", "FILE", "--rhs", "b.mtx"}, "a Matrix Market file"},
        Reader{"rhs", {"solve", "--matrix", "A.mtx", "--rhs", "FILE"}, "a Matrix Market file"}));

}  // namespace
}  // namespace hvp::cli::file_kinds_test
