#include "app/scene/samples.h"

#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/app/scratch_directory.h"

namespace hvp::app::samples_test {
namespace {

std::vector<double> samples(const std::string& text) {
  const ScratchDirectory place;
  const std::filesystem::path file = place.path() / "log.csv";
  std::ofstream(file, std::ios::binary) << text;
  return read_samples(file);
}

std::string refusal(const std::string& text) {
  try {
    samples(text);
  } catch (const InputError& e) {
    EXPECT_EQ(e.key(), "samples");
    return e.what();
  }
  return "taken";
}

TEST(Samples, AreTheFirstColumnWithAUnit) {
  EXPECT_EQ(samples("late_us\n1.5\n20\n"), (std::vector<double>{1.5e-6, 20e-6}));
  EXPECT_EQ(samples("number,\"late_ns\",other_s\n1, 250 ,7\r\n\n2,3e3,8\n"),
            (std::vector<double>{250e-9, 3e-6}));
  EXPECT_EQ(samples("t_ms\n0\n"), (std::vector<double>{0}));
  EXPECT_EQ(samples("t_s\n1\n"), (std::vector<double>{1}));
}

TEST(Samples, ComeFromEveryProgram) {
  const std::vector<double> expected = {1.5e-3, 2e-3};
  EXPECT_EQ(samples("\xEF\xBB\xBFt_ms\r\n1.5\r\n2\r\n"), expected);
  EXPECT_EQ(samples("name;t_ms\n\"a;b\";1.5\nc;2\n"), expected);
  EXPECT_EQ(samples("# of a rig\nt_ms\n1.5\n2\n"), expected);
}

TEST(Samples, RefusalsNameTheLine) {
  EXPECT_NE(refusal("").find("line 1: expected names of columns"), std::string::npos);
  EXPECT_NE(refusal("1\n2\n").find("line 1: expected names of columns"), std::string::npos);
  EXPECT_NE(refusal("t_us\n1\n-1\n").find("line 3: "), std::string::npos);
  EXPECT_NE(refusal("t_us\n1\n2 us\n").find("line 3: "), std::string::npos);
  EXPECT_NE(refusal("t_s\n1.5\n").find("found \"1.5\""), std::string::npos);
  EXPECT_NE(refusal("a,t_us\n1\n").find("line 2: "), std::string::npos);
  EXPECT_NE(refusal("t_us\nnan\n").find("line 2: "), std::string::npos);
  EXPECT_NE(refusal("t_us\n\n").find("no sample"), std::string::npos);
  EXPECT_EQ(refusal("t_us\n3\n5 m\n"),
            "log.csv: line 3: expected a time from 0 to 1 s in column 1, found \"5 m\"");
}

}  // namespace
}  // namespace hvp::app::samples_test
