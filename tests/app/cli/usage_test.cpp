#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

namespace hvp::cli::usage_test {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

TEST(Usage, VersionNamesTheProgram) {
  const ScratchDirectory place;
  const Ended ended = hvp(place.path(), {"--version"});
  EXPECT_EQ(ended.status, 0);
  EXPECT_THAT(ended.out, MatchesRegex("hvp [0-9]+\\.[0-9]+\\.[0-9]+\n"));
  EXPECT_EQ(ended.err, "");
}

TEST(Usage, HelpNamesEveryCommandAndTheExitStatus) {
  const ScratchDirectory place;
  const Ended ended = hvp(place.path(), {"--help"});
  EXPECT_EQ(ended.status, 0);
  for (const char* word :
       {"run", "explain", "misses", "serve", "replay", "solve", "mesh", "export", "resolve",
        "reference", "study", "sweep", "compare", "report", "Exit status"}) {
    EXPECT_THAT(ended.out, HasSubstr(word));
  }
  EXPECT_EQ(ended.err, "");
}

TEST(Usage, EveryCommandHasHelp) {
  const ScratchDirectory place;
  for (const char* command : {"run", "explain", "misses", "serve", "replay", "solve", "mesh",
                              "export", "resolve", "reference"}) {
    const Ended ended = hvp(place.path(), {command, "--help"});
    EXPECT_EQ(ended.status, 0);
    EXPECT_THAT(ended.out, HasSubstr(std::string("Usage: hvp ") + command));
  }
}

struct Wrong {
  std::vector<std::string> arguments;
  std::string line;

  friend void PrintTo(const Wrong& wrong, std::ostream* out) {
    std::string words = "hvp";
    for (const std::string& argument : wrong.arguments) words += " " + argument;
    *out << slug(words);
  }
};

class WrongUsage : public ::testing::TestWithParam<Wrong> {};

TEST_P(WrongUsage, IsOneLineAndStatusTwo) {
  const ScratchDirectory place;
  const Ended ended = hvp(place.path(), GetParam().arguments);
  EXPECT_EQ(ended.status, 2);
  EXPECT_EQ(ended.out, "");
  EXPECT_EQ(lines(ended.err).size(), 1U) << ended.err;
  EXPECT_THAT(ended.err, EndsWith("\n"));
  EXPECT_THAT(ended.err, HasSubstr(GetParam().line));
  EXPECT_TRUE(names(place.path()).empty());
}

INSTANTIATE_TEST_SUITE_P(
    CommandLine, WrongUsage,
    ::testing::Values(
        Wrong{{},
              "expected a command: run, explain, misses, device, stability, serve, linux, replay, "
              "fit, "
              "measure, solve, mesh, export, rtl, resolve, reference"},
        Wrong{{"rum"}, "unknown command rum; did you mean run?"},
        Wrong{{"simulate"}, "unknown command simulate; there is run, explain"},
        Wrong{{"study", "axes.toml"}, "hvp: study is run by ./hvp study …"},
        Wrong{{"sweep"}, "hvp: sweep is run by ./hvp sweep …"},
        Wrong{{"compare", "a", "b", "--json"}, "hvp: compare is run by ./hvp compare …"},
        Wrong{{"report", "runs/x"}, "hvp: report is run by ./hvp report …"},
        Wrong{{"reference", "--json", "--results"}, "reference: --results excludes --json"},
        Wrong{{"replay"}, "replay: record is required"},
        Wrong{{"replay", "a.bin", "a.toml", "--against", "b.bin"},
              "replay: scenario excludes --against"},
        Wrong{{"resolve"}, "resolve: scenario is required"},
        Wrong{{"resolve", "none.toml", "--each"}, "none.toml: no such file"},
        Wrong{{"--versoin"}, "unknown option --versoin; did you mean --version?"},
        Wrong{{"--set", "a=b", "run", "x.toml"},
              "--set belongs behind the command: hvp run … --set"},
        Wrong{{"--set=a=b"}, "--set belongs behind the command: hvp run … --set"},
        Wrong{{"run"}, "run: scenario is required"},
        Wrong{{"run", "a.toml", "b.toml"}, "run: one argument too many: b.toml"},
        Wrong{{"run", "a.toml", "--quite"}, "unknown option --quite; did you mean --quiet?"},
        Wrong{{"run", "a.toml", "--trace-register"}, "did you mean --trace-registers?"},
        Wrong{{"run", "a.toml", "--frames=3"}, "unknown option --frames; there is"},
        Wrong{{"run", "a.toml", "--out"}, "--out: 1 required FOLDER missing"},
        Wrong{{"run", "a.toml", "--set"}, "--set: 1 required KEY=VALUE missing"},
        Wrong{{"export", "a.toml"}, "export: --out is required"},
        Wrong{{"serve"}, "serve: scenario is required"},
        Wrong{{"serve", "a.toml"}, "serve: --vfio-user is required"},
        Wrong{{"serve", "a.toml", "--vfio-user", ""}, "serve: --vfio-user: expected a value"},
        Wrong{{"serve", "a.toml", "--vfio-user", "b", "--out", "c"},
              "serve: --out requires --trace-registers"},
        Wrong{{"serve", "a.toml", "--vfio-usr", "b"}, "did you mean --vfio-user?"},
        Wrong{{"solve"}, "solve: --matrix is required"},
        Wrong{{"solve", "--matrix", "a.mtx"}, "solve: --rhs is required"},
        Wrong{{"solve", "--matrx", "a.mtx"}, "did you mean --matrix?"},
        Wrong{{"mesh"}, "mesh: surface is required"},
        Wrong{{"mesh", "sphere", "--nodes", "many"}, "--nodes"},
        Wrong{{"mesh", "sphere", "--nodes", "3"}, "out of range: expected from 4 to 1000000"},
        Wrong{{"mesh", "sphere", "--size", "50"}, "missing unit: expected a length"},
        Wrong{{"mesh", "sphere", "--size", "5 kg"}, "wrong unit: expected a length"},
        Wrong{{"mesh", "box", "--size", "0 mm"}, "out of range: expected from 1 um to 1 km"},
        Wrong{{"mesh", "sphere", "--unit", "1 mm"}, "--unit belongs to a surface file only"},
        Wrong{{"mesh", "a.stl", "--size", "1 mm"}, "--size belongs to sphere and box only"},
        Wrong{{"mesh", "a.stl", "--unit", "0 mm"}, "out of range: expected from 1 nm to 1 km"},
        Wrong{{"mesh", "sphre"}, "sphre: no such file: expected a surface file"},
        Wrong{{"run", ""}, "run: scenario: expected a value, found \"\""},
        Wrong{{"run", "a.toml", "--out", ""}, "run: --out: expected a value, found \"\""},
        Wrong{{"run", "a.toml", "--out="}, "run: --out"},
        Wrong{{"run", "a.toml", "--set", ""}, "run: --set: expected a value"},
        Wrong{{"export", "a.toml", "--out", ""}, "export: --out: expected a value"},
        Wrong{{"mesh", "sphere", "--out", ""}, "mesh: --out: expected a value"},
        Wrong{{"mesh", "sphere", "--size", ""}, "mesh: --size: expected a value"},
        Wrong{{"mesh", ""}, "mesh: surface: expected a value"},
        Wrong{{"solve", "--matrix", "", "--rhs", "b"}, "solve: --matrix: expected a value"},
        Wrong{{"solve", "--matrix", "a", "--rhs", "b", "--solution", ""},
              "solve: --solution: expected a value"},
        Wrong{{"solve", "--matrix", "a", "--rhs", "b", "--kernel", ""},
              "solve: --kernel: expected a value"},
        Wrong{{"mesh", "sphere", "--out", "mesh.stl"}, "expected a file that ends in .vtu"}));

TEST(Usage, AControlCharacterDoesNotBreakTheLine) {
  const ScratchDirectory place;
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"r\nun"}, {"run", "a\nb.toml"}, {"run", "a", "--x\ny"}}) {
    const Ended ended = hvp(place.path(), arguments);
    EXPECT_EQ(ended.status, 2);
    EXPECT_EQ(lines(ended.err).size(), 1U) << ended.err;
  }
}

}  // namespace
}  // namespace hvp::cli::usage_test
