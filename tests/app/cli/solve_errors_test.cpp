#include <gmock/gmock.h>

#include "tests/app/cli/linear_systems.h"

// What `hvp solve` refuses: status 2, one line, and nothing written.
namespace hvp::cli::solve_errors_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::vector<double> kOnes3 = {1, 1, 1};

void expect_refused(const Ended& ended, const std::string& line) {
  EXPECT_EQ(ended.status, 2);
  EXPECT_EQ(ended.out, "");
  EXPECT_EQ(lines(ended.err).size(), 1U) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr(line));
}

TEST(SolveErrors, OfTheMatrix) {
  const std::string symmetric = "%%MatrixMarket matrix coordinate real symmetric\n";
  const std::string general = "%%MatrixMarket matrix coordinate real general\n";
  const struct {
    std::string text;
    std::string line;
  } cases[] = {
      {symmetric + "3 4 1\n1 1 1\n", "A.mtx, line 2: the matrix is 3 × 4; expected a square one"},
      {general + "3 3 4\n1 1 1\n1 2 1\n2 2 1\n3 3 1\n", "the matrix is not symmetric"},
      {symmetric + "3 3 3\n1 1 1\n2 2 nan\n3 3 1\n", "A.mtx, line 4: the entry is 'nan'"},
      {symmetric + "3 3 2\n1 1 1\n2 2 1\n", "a row is empty"},
      {"no matrix\n", "A.mtx, line 1: expected '%%MatrixMarket"},
      {symmetric + "3 3 3\n1 1 1\n2 2 -5\n3 3 1\n",
       "--matrix A.mtx: the matrix is not positive definite: its diagonal entry (2, 2) is -5"},
      {symmetric + "3 3 3\n1 1 1\n2 1 1\n3 3 1\n", "its diagonal entry (2, 2) is 0"},
      {symmetric + "3 3 4\n1 1 1\n2 2 1\n3 3 1\n2 1 3\n",
       "the matrix is not positive definite: 1 of its 3 eigenvalues are negative"},
      {symmetric + "3 3 5\n1 1 1\n2 2 2\n3 3 1\n2 1 -1\n3 2 -1\n",
       "it is singular to double precision"},
  };
  for (const auto& c : cases) {
    const SystemFolder folder(3, chain(3), kOnes3);
    write(folder.path() / "A.mtx", c.text);
    expect_refused(folder.solve(), c.line);
    EXPECT_THAT(names(folder.path()), ElementsAre("A.mtx", "b.mtx"));
  }
}

TEST(SolveErrors, OfTheRightHandSide) {
  const std::string array = "%%MatrixMarket matrix array real general\n";
  const struct {
    std::string text;
    std::string line;
  } cases[] = {
      {array + "2 1\n1\n1\n",
       "--rhs b.mtx: has 2 entries: expected 3, as many as the matrix has rows"},
      {array + "3 1\n1\ninf\n1\n", "b.mtx, line 4: the entry is 'inf'"},
      {array + "3 2\n1\n1\n1\n1\n1\n1\n", "expected a vector"},
      {array + "3 1\n1\n", "the file ends"},
      {"", "the file is empty"},
  };
  for (const auto& c : cases) {
    const SystemFolder folder(3, chain(3), kOnes3);
    write(folder.path() / "b.mtx", c.text);
    expect_refused(folder.solve(), c.line);
  }
}

TEST(SolveErrors, OfFiles) {
  const SystemFolder folder(3, chain(3), kOnes3);
  std::filesystem::create_directories(folder.path() / "d");
  expect_refused(hvp(folder.path(), {"solve", "--matrix", "B.mtx", "--rhs", "b.mtx"}),
                 "--matrix B.mtx: no such file");
  expect_refused(hvp(folder.path(), {"solve", "--matrix", "A.mtx", "--rhs", "d"}),
                 "--rhs d: is a folder: expected a Matrix Market file");
  expect_refused(folder.solve({"--solution", "d"}), "--solution d: is a folder: expected a file");
  expect_refused(folder.solve({"--solution", "A.mtx/x.mtx"}), "--solution A.mtx");
  expect_refused(folder.solve({"--solution", "A.mtx"}), "--solution A.mtx: is the --matrix itself");
  expect_refused(folder.solve({"--solution", "./b.mtx"}),
                 "--solution ./b.mtx: is the --rhs itself");
}

TEST(SolveErrors, OfSettings) {
  const SystemFolder folder(3, chain(3), kOnes3);
  const struct {
    std::vector<std::string> arguments;
    std::string line;
  } cases[] = {
      {{"--set", "solver.iteratons=3"},
       "--set solver.iteratons=3: unknown key; did you mean \"iterations\"?"},
      {{"--set", "solver.vector_bits=40"}, "out of range: expected from 12 to 32, found 40"},
      {{"--set", "solver.displacement_range=3"}, "missing unit: expected a length"},
      {{"--set", "solver.start=warm"}, "there is no earlier solution to start from"},
      {{"--set", "solver.vector_bits=12", "--set", "solver.headroom_bits=7"},
       "--set solver.headroom_bits=7: 7 free bits leave fewer"},
      {{"--set", "accelerator.clock=120 MHz"},
       "--set accelerator.clock=120 MHz: 120.0 MHz is beyond what the EP2S60 reaches"},
      {{"--set", "object.mesh.nodes=3"}, "unknown key; the scenario has solver"},
      {{"--set", "solver"}, "expected KEY=VALUE"},
      {{"--set", "refinement.passes=0"}, "out of range"},
      {{"--tolerance", "0"}, "--tolerance 0: out of range: expected a number above zero"},
      {{"--tolerance", "nan"}, "--tolerance nan"},
      {{"--tolerance", "much"}, "--tolerance"},
      {{"--kernel", "abacus"}, "--kernel abacus: a kernel \"abacus\" does not exist"},
  };
  for (const auto& c : cases) expect_refused(folder.solve(c.arguments), c.line);
}

// Not singular: units that differ by as much as doubles hold.
TEST(SolveErrors, NotOfUnitsThatDiffer) {
  const std::vector<Entry> lower = {{1, 1, 1e-150}, {2, 2, 1}, {3, 3, 1e150}};
  const SystemFolder folder(3, lower, {1e-150, 1, 1e150});
  const Ended ended = folder.solve({"--set", "solver.matrix_scaling=diagonal"});
  EXPECT_EQ(ended.status, 0) << ended.err;
}

// Rows that fill the last block of three are not the user's.
TEST(SolveErrors, CountTheEquationsThatWereGiven) {
  const SystemFolder folder(2, {{1, 1, 1}, {2, 1, 2}, {2, 2, 1}}, {1, 1});
  expect_refused(folder.solve(), "1 of its 2 eigenvalues are negative");
}

// A number that is not zero is not shown as zero.
TEST(SolveErrors, ShowSmallNumbers) {
  const SystemFolder folder(2, {{1, 1, 1e-305}, {2, 2, 1e-305}}, {1, 1});
  expect_refused(folder.solve(), "the largest entry of the matrix is 1e-305");
}

}  // namespace
}  // namespace hvp::cli::solve_errors_test
