#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "tests/app/cli/linear_systems.h"

// `hvp solve` on systems whose solution is known.
namespace hvp::cli::solve_test {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr int kLinks = 20;

std::vector<double> wave(int n) {
  std::vector<double> x(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) x[static_cast<std::size_t>(i)] = std::cos(0.4 * i);
  return x;
}

SystemFolder chain_folder(double stiffness = 1, double size = 1) {
  std::vector<double> x = wave(kLinks);
  for (double& entry : x) entry *= size;
  return {kLinks, chain(kLinks, stiffness), product(kLinks, chain(kLinks, stiffness), x)};
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    largest = std::max(largest, std::abs(a[i] - b[i]));
  }
  return largest;
}

bool has_flag(const json& result, const char* flag) {
  const json& flags = result.at("flags");
  return std::find(flags.begin(), flags.end(), flag) != flags.end();
}

TEST(Solve, PrintsOneObjectWithTheseKeys) {
  const SystemFolder folder = chain_folder();
  const Ended ended = folder.solve();
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.err, "");
  const auto result = nlohmann::ordered_json::parse(ended.out);
  std::vector<std::string> keys;
  for (const auto& item : result.items()) keys.push_back(item.key());
  EXPECT_THAT(keys,
              ElementsAre("dimension", "nonzeros", "solves", "iterations", "error_rel",
                          "error_rel_quantised", "residual_rel", "residual_rel_quantised",
                          "residual_recursive_rel", "saturations", "wraps", "breakdowns",
                          "clamped_words", "flags", "remedies", "remedy", "tolerance", "cycles",
                          "time_us", "device", "fits", "resources", "x_unit", "x_range_from",
                          "nonpositive_eigenvalues_quantised", "condition", "settings"));
  EXPECT_THAT(names(folder.path()), ElementsAre("A.mtx", "b.mtx", "solution.mtx"));
}

// What is printed as a remedy is given as printed: no flag is left, and the device holds it.
// Scaling, which costs nothing, before passes and bits.
TEST(Solve, ARemedyWorksAsPrinted) {
  for (const char* name : {"bcsstk01", "bcsstk03"}) {
    const SystemFolder folder{std::string(name)};
    const json before = folder.result();
    EXPECT_THAT(before.at("flags"), Not(IsEmpty())) << name;
    EXPECT_GT(before.at("error_rel"), 1) << name;
    const json& remedy = before.at("remedy");
    ASSERT_TRUE(remedy.at("works")) << remedy;
    std::vector<std::string> sets;
    std::string line;
    for (const json& set : remedy.at("set")) {
      sets.push_back(set.get<std::string>());
      line += (line.empty() ? "--set " : " --set ") + sets.back();
    }
    EXPECT_EQ(remedy.at("line"), line);
    EXPECT_THAT(sets, testing::Contains("solver.matrix_scaling=diagonal")) << name;
    const json after = folder.result(sets);
    EXPECT_THAT(after.at("flags"), IsEmpty()) << name;
    EXPECT_TRUE(after.at("fits")) << name;
    EXPECT_EQ(after.at("error_rel"), remedy.at("error_rel")) << name;
    EXPECT_LT(after.at("error_rel"), 0.01) << name;
  }
  EXPECT_EQ(SystemFolder(std::string("nos4")).result().at("remedy"), nullptr);
}

TEST(Solve, HasTheDesignsDefaults) {
  const json result = chain_folder().result();
  const json& solver = result.at("settings").at("solver");
  EXPECT_EQ(solver.at("method"), "jacobi-pcg");
  EXPECT_EQ(solver.at("start"), "zero");
  EXPECT_EQ(solver.at("iterations"), 60);
  EXPECT_EQ(solver.at("matrix_bits"), 12);
  EXPECT_EQ(solver.at("vector_bits"), 16);
  EXPECT_EQ(result.at("device"), "EP2S60");
  EXPECT_EQ(result.at("condition"), nullptr);
  EXPECT_EQ(result.at("settings").at("refinement"), nullptr);
}

TEST(Solve, FindsTheSolution) {
  const SystemFolder folder = chain_folder();
  const json result = folder.result();
  EXPECT_EQ(result.at("dimension"), kLinks);
  EXPECT_EQ(result.at("nonzeros"), 3 * kLinks - 2);
  // 2 and -1 are words of 12 bits but for the scale 2/2047: -1 is off by 1/2047.
  EXPECT_EQ(result.at("nonpositive_eigenvalues_quantised"), 0);
  EXPECT_LT(result.at("error_rel_quantised"), 1e-3);
  EXPECT_LT(result.at("error_rel"), 0.06);
  EXPECT_GT(result.at("error_rel"), result.at("error_rel_quantised"));
  EXPECT_THAT(result.at("flags"), IsEmpty());
  EXPECT_THAT(result.at("remedies"), IsEmpty());
  // The file has the solution whose error was printed.
  const std::vector<double> x = wave(kLinks);
  const std::vector<double> found = folder.solution();
  double distance = 0;
  double size = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    distance += (found[i] - x[i]) * (found[i] - x[i]);
    size += x[i] * x[i];
  }
  EXPECT_NEAR(std::sqrt(distance / size), result.at("error_rel").get<double>(), 1e-12);
}

// Words that stand for the entries exactly leave the solver's own error alone.
TEST(Solve, OfAMatrixThatTheWordsHoldHasOneError) {
  std::vector<Entry> lower = chain(kLinks, 512);
  lower.front().value = 2047;
  const SystemFolder folder(kLinks, lower, product(kLinks, lower, wave(kLinks)));
  const json result = folder.result({"solver.vector_bits=20"});
  EXPECT_NEAR(result.at("error_rel").get<double>(), result.at("error_rel_quantised").get<double>(),
              1e-12);
  EXPECT_LT(result.at("error_rel"), 1e-4);
  EXPECT_EQ(result.at("residual_rel"), result.at("residual_rel_quantised"));
  EXPECT_LT(largest_difference(folder.solution(), wave(kLinks)), 1e-4);
}

// The accelerator has no units: powers of two change the unit of x and nothing else.
TEST(Solve, IsTheSameInAnyUnit) {
  json plain = chain_folder().result();
  for (const auto& [stiffness, size] :
       {std::pair{0x1p60, 0x1p-30}, {0x1p-40, 1.0}, {1.0, 0x1p80}}) {
    json other = chain_folder(stiffness, size).result();
    EXPECT_EQ(other.at("x_unit").get<double>(), size * plain.at("x_unit").get<double>());
    for (const char* key : {"x_unit", "settings"}) other.erase(key);
    json expected = plain;
    for (const char* key : {"x_unit", "settings"}) expected.erase(key);
    EXPECT_EQ(other, expected);
  }
}

TEST(Solve, TimeIsClocksOfTheDevice) {
  const json at_100_mhz = chain_folder().result();
  EXPECT_EQ(at_100_mhz.at("time_us").get<double>(), at_100_mhz.at("cycles").get<double>() / 100);
  const json slow = chain_folder().result({"accelerator.clock=50 MHz"});
  EXPECT_EQ(slow.at("cycles"), at_100_mhz.at("cycles"));
  EXPECT_EQ(slow.at("time_us").get<double>(), 2 * at_100_mhz.at("time_us").get<double>());
  const json half = chain_folder().result({"solver.iterations=30"});
  EXPECT_EQ(half.at("iterations"), 30);
  EXPECT_LT(half.at("cycles"), at_100_mhz.at("cycles"));
}

// The defaults of the command on its default device: any system that a board with Jacobi-PCG can
// hold. The thesis' sphere, 500 nodes, is one.
TEST(Solve, TheDefaultsFitTheDefaultDevice) {
  EXPECT_EQ(chain_folder().result().at("fits"), true);
  const ScratchDirectory place;
  const Ended exported = hvp(place.path(), {"export", scenario("thesis-static.toml").string(),
                                            "--out", "system", "--set", "loads.gravity=true"});
  ASSERT_EQ(exported.status, 0) << exported.err;
  const Ended ended =
      hvp(place.path(), {"solve", "--matrix", "system/K.mtx", "--rhs", "system/b.mtx"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const json result = json::parse(ended.out);
  EXPECT_EQ(result.at("device"), "EP2S60");
  EXPECT_EQ(result.at("settings").at("solver").at("method"), "jacobi-pcg");
  EXPECT_EQ(result.at("settings").at("solver").at("iterations"), 60);
  EXPECT_EQ(result.at("fits"), true) << result.at("resources");
}

// Another device has other memory types: the default is then the rule.
TEST(Solve, AnotherDeviceHasADefaultToo) {
  const json result = chain_folder().result({"accelerator.device=5SGXA7"});
  EXPECT_EQ(result.at("settings").at("accelerator").at("preconditioner_memory"), "auto");
  const json chosen = chain_folder().result({"accelerator.preconditioner_memory=M4K"});
  EXPECT_EQ(chosen.at("settings").at("accelerator").at("preconditioner_memory"), "M4K");
}

TEST(Solve, SaysWhetherTheDeviceHoldsIt) {
  const json small = chain_folder().result({"solver.method=cg"});
  EXPECT_EQ(small.at("fits"), true);
  constexpr int kMany = 9000;
  const SystemFolder large(kMany, chain(kMany), std::vector<double>(kMany, 1e-6));
  const json result = large.result({"solver.method=cg"});
  EXPECT_EQ(result.at("fits"), false);
  EXPECT_EQ(result.at("dimension"), kMany);
  bool over = false;
  for (const json& r : result.at("resources")) over |= r.at("used") > r.at("available");
  EXPECT_TRUE(over);
  EXPECT_EQ(large.solution().size(), static_cast<std::size_t>(kMany));
}

TEST(Solve, ToleranceDecidesTheExitStatus) {
  const SystemFolder folder = chain_folder();
  EXPECT_EQ(folder.solve({"--tolerance", "0.5"}).status, 0);
  const Ended missed = folder.solve({"--tolerance", "1e-9", "--solution", "x.mtx"});
  EXPECT_EQ(missed.status, 1);
  EXPECT_EQ(missed.err, "");
  const json result = json::parse(missed.out);
  EXPECT_EQ(result.at("tolerance"), 1e-9);
  EXPECT_FALSE(result.at("flags").empty());
  EXPECT_EQ(read_vector(folder.path() / "x.mtx").size(), static_cast<std::size_t>(kLinks));
}

TEST(Solve, EveryFlagHasARemedy) {
  const json result = SystemFolder("bcsstk01").result();
  ASSERT_FALSE(result.at("flags").empty());
  ASSERT_EQ(result.at("remedies").size(), result.at("flags").size());
  for (std::size_t i = 0; i < result.at("flags").size(); ++i) {
    EXPECT_EQ(result.at("remedies").at(i).at("flag"), result.at("flags").at(i));
    EXPECT_NE(result.at("remedies").at(i).at("remedy"), "");
    EXPECT_NE(result.at("remedies").at(i).at("meaning"), "");
  }
}

TEST(Solve, TheRangeIsChosenSoThatNothingIsClamped) {
  for (const char* method : {"cg", "jacobi-pcg", "block-jacobi-pcg", "chronopoulos-gear"}) {
    const json chosen = chain_folder().result({std::string("solver.method=") + method});
    EXPECT_EQ(chosen.at("clamped_words"), 0) << method;
    EXPECT_FALSE(has_flag(chosen, "range-exceeded")) << method;
    EXPECT_NE(chosen.at("x_range_from"), "given") << method;
  }
  // A load so concentrated that b, not x, sets the unit of plain CG with a small shift.
  const json by_b = chain_folder().result({"solver.method=cg", "solver.static_shift=5"});
  EXPECT_EQ(by_b.at("x_range_from"), "right-hand side");
  EXPECT_EQ(by_b.at("clamped_words"), 0);
}

TEST(Solve, ARangeThatIsGivenIsTaken) {
  const json wide = chain_folder().result({"solver.displacement_range=10 m"});
  EXPECT_EQ(wide.at("x_range_from"), "given");
  EXPECT_DOUBLE_EQ(wide.at("x_unit").get<double>(), 10.0 / 32767);
  EXPECT_EQ(wide.at("settings").at("solver").at("displacement_range"), "10 m");
  EXPECT_THAT(wide.at("flags"), IsEmpty());
  const json narrow = chain_folder().result({"solver.displacement_range=0.1 m"});
  EXPECT_TRUE(has_flag(narrow, "saturation"));
  const json clamped = chain_folder().result(
      {"solver.displacement_range=1 um", "solver.method=cg", "solver.static_shift=5"});
  EXPECT_TRUE(has_flag(clamped, "range-exceeded"));
  EXPECT_GT(clamped.at("clamped_words"), 0);
}

TEST(Solve, OfZeroIsZero) {
  const SystemFolder folder(kLinks, chain(kLinks), std::vector<double>(kLinks, 0.0));
  const json result = folder.result();
  EXPECT_EQ(result.at("error_rel"), 0.0);
  EXPECT_EQ(result.at("residual_rel"), 0.0);
  EXPECT_THAT(result.at("flags"), IsEmpty());
  EXPECT_EQ(folder.solution(), std::vector<double>(kLinks, 0.0));
}

TEST(Solve, RefinementLeadsToTheTrueSolution) {
  const SystemFolder folder = chain_folder();
  const json once = folder.result();
  const json refined = folder.result({"refinement.passes=3"});
  EXPECT_EQ(refined.at("solves"), 3);
  EXPECT_EQ(refined.at("iterations"), 180);
  EXPECT_EQ(refined.at("cycles"), 3 * once.at("cycles").get<std::int64_t>());
  // Each pass leaves what its rounding makes of the last one's rest: less than a tenth.
  EXPECT_LT(refined.at("error_rel").get<double>(), 0.01 * once.at("error_rel").get<double>());
}

TEST(Solve, TheChosenShiftIsStated) {
  const json result =
      chain_folder().result({"solver.method=cg", "solver.static_scale=matrix-norm"});
  // A row's magnitudes sum up to 4095 in words of 12 bits: 2^12.
  EXPECT_EQ(result.at("settings").at("solver").at("static_shift"), 12);
}

TEST(Solve, GivesTheSameBytesAnywhere) {
  const SystemFolder a = chain_folder();
  const SystemFolder b = chain_folder();
  const Ended first = a.solve();
  const Ended second = b.solve({"--solution", "deep/er/x.mtx"});
  EXPECT_EQ(first.out, second.out);
  EXPECT_EQ(read(a.path() / "solution.mtx"), read(b.path() / "deep/er/x.mtx"));
}

TEST(Solve, GivesTheSameBytesWithEveryKernel) {
  const SystemFolder folder("nos4");
  const Ended reference = folder.solve({"--kernel", "reference"});
  const std::string solution = read(folder.path() / "solution.mtx");
  ASSERT_EQ(reference.status, 0) << reference.err;
  for (const char* kernel : {"portable", "avx2", "avx512"}) {
    const Ended ended = folder.solve({"--kernel", kernel});
    if (ended.status == 2) {
      EXPECT_THAT(ended.err, HasSubstr("this machine does not have the kernel"));
      continue;
    }
    EXPECT_EQ(ended.out, reference.out) << kernel;
    EXPECT_EQ(read(folder.path() / "solution.mtx"), solution) << kernel;
  }
}

TEST(Solve, ThatCannotBeWrittenIsStatusThree) {
  const SystemFolder folder = chain_folder();
  std::filesystem::create_directories(folder.path() / "x.mtx.part/mine");
  const Ended ended = folder.solve({"--solution", "x.mtx"});
  EXPECT_EQ(ended.status, 3);
  EXPECT_EQ(ended.out, "");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "x.mtx"));
}

// Stiffness matrices of real structures, whose unknowns are lengths and angles.
TEST(Structures, WorkOrSayWhyTheyDoNot) {
  const std::vector<std::string> wide = {"solver.matrix_scaling=diagonal", "solver.matrix_bits=24",
                                         "solver.vector_bits=28", "solver.scalar_bits=128",
                                         "solver.iterations=300"};
  // κ is 1.6e3: the default words do.
  const json nos4 = SystemFolder("nos4").result();
  EXPECT_THAT(nos4.at("flags"), IsEmpty());
  EXPECT_LT(nos4.at("error_rel"), 0.06);
  // 8.8e5 and 6.8e6: 12 bits lose whole rows; the diagonal's scaling brings them back, and wider
  // words or refinement the digits.
  for (const char* name : {"bcsstk01", "bcsstk03"}) {
    const SystemFolder folder(name);
    const json narrow = folder.result();
    EXPECT_TRUE(has_flag(narrow, "zero-diagonal")) << name;
    EXPECT_TRUE(has_flag(narrow, "negative-curvature")) << name;
    EXPECT_TRUE(has_flag(narrow, "matrix-rounding")) << name;
    EXPECT_EQ(narrow.at("error_rel_quantised"), nullptr) << name;

    const json scaled = folder.result({"solver.matrix_scaling=diagonal"});
    EXPECT_EQ(scaled.at("nonpositive_eigenvalues_quantised"), 0) << name;
    EXPECT_FALSE(scaled.at("flags").empty()) << name;

    const json solved = folder.result(wide);
    EXPECT_THAT(solved.at("flags"), IsEmpty()) << name;
    EXPECT_LT(solved.at("error_rel"), 2e-3) << name;
  }
  const json refined = SystemFolder("bcsstk01")
                           .result({"solver.matrix_scaling=diagonal", "solver.matrix_bits=18",
                                    "solver.vector_bits=20", "refinement.passes=6"});
  EXPECT_THAT(refined.at("flags"), IsEmpty());
  EXPECT_LT(refined.at("error_rel"), 1e-12);
}

}  // namespace
}  // namespace hvp::cli::solve_test
