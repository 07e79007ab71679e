// hvp-draw under a real Xvfb. The build adds this file only where Xvfb is installed.

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include "app/results/pictures.h"
#include "tests/app/sample_loop.h"
#include "tests/app/sample_run.h"
#include "tests/app/scratch_directory.h"

namespace hvp::results::draw_render_test {
namespace {

using Colour = std::array<int, 3>;

constexpr Colour kPaper = {250, 249, 246};  // app/draw/canvas.h

class Picture {
 public:
  explicit Picture(const std::filesystem::path& path) {
    EXPECT_TRUE(std::filesystem::exists(path)) << path;
    reader_->SetFileName(path.c_str());
    reader_->Update();
    image_ = reader_->GetOutput();
  }
  int width() const { return image_->GetDimensions()[0]; }
  int height() const { return image_->GetDimensions()[1]; }
  Colour at(int x, int y) const {
    const auto* p = static_cast<unsigned char*>(image_->GetScalarPointer(x, y, 0));
    return {p[0], p[1], p[2]};
  }
  template <class Wanted>
  int count(Wanted wanted) const {
    int pixels = 0;
    for (int y = 0; y < height(); ++y)
      for (int x = 0; x < width(); ++x) pixels += wanted(at(x, y)) ? 1 : 0;
    return pixels;
  }
  std::size_t colours() const {
    std::set<Colour> seen;
    count([&](const Colour& c) { return seen.insert(c).second; });
    return seen.size();
  }

 private:
  vtkNew<vtkPNGReader> reader_;
  vtkImageData* image_ = nullptr;
};

// Hues rather than colours: the edges of a mark are mixed with what is behind it.
bool is_red(const Colour& c) { return c[0] - c[1] > 90 && c[0] - c[2] > 90; }
bool is_blue(const Colour& c) { return c[2] - c[0] > 60 && c[1] > 60; }
bool is_orange(const Colour& c) { return c[0] - c[1] > 80 && c[1] - c[2] > 40 && c[2] < 90; }
bool is_pink(const Colour& c) {
  return c[0] > 220 && c[0] - c[1] > 20 && std::abs(c[1] - c[2]) < 15;
}
bool is_pale_blue(const Colour& c) { return c == Colour{218, 231, 240}; }
bool is_arrow(const Colour& c) { return c[0] > 150 && c[1] < 80 && c[2] < 60 && c[2] < c[1] + 5; }

class DrawRenderTest : public testing::Test {
 protected:
  PictureOutcome draw(const sample::RunShape& shape) {
    sample::write_run(scratch_.path(), shape);
    return redraw();
  }
  PictureOutcome redraw() { return draw_pictures(scratch_.path(), tools()); }
  static PictureTools tools() {
    PictureTools tools = PictureTools::of_this_process();
    tools.draw_program = HVP_DRAW_PROGRAM;
    tools.display.clear();
    return tools;
  }
  Picture loop_picture(const sample::LoopShape& shape) {
    sample::write_run(scratch_.path(), {.frames = 6000, .step_every = 6000, .cells = 2});
    sample::add_loop(scratch_.path(), shape);
    std::filesystem::remove(file("deformation.pvd"));
    const auto outcome = redraw();
    EXPECT_TRUE(outcome.drawn) << outcome.reason;
    EXPECT_EQ(outcome.files, (std::vector<std::string>{"latency.png", "loop.png"}));
    return Picture(file("loop.png"));
  }
  std::filesystem::path file(const char* name) const { return scratch_.path() / name; }

  ScratchDirectory scratch_;
};

TEST_F(DrawRenderTest, DrawsBothPicturesInTheStatedSize) {
  const auto outcome = draw({});
  ASSERT_TRUE(outcome.drawn) << outcome.reason;
  EXPECT_EQ(outcome.files, (std::vector<std::string>{"deformation.png", "latency.png"}));
  for (const char* name : {"deformation.png", "latency.png"}) {
    const Picture picture(file(name));
    EXPECT_EQ(picture.width(), 1400);
    EXPECT_EQ(picture.height(), 1000);
    EXPECT_GT(picture.colours(), 100u) << name;
    EXPECT_EQ(picture.at(2, 2), kPaper) << name;
  }
  for (const auto& entry : std::filesystem::directory_iterator(scratch_.path()))
    EXPECT_NE(entry.path().extension(), ".part");
}

TEST_F(DrawRenderTest, ShowsTheStepOfTheLargestForceWithItsArrow) {
  ASSERT_TRUE(draw({}).drawn);
  const int with_force = Picture(file("deformation.png")).count(is_arrow);
  // One step only, before the contact.
  ASSERT_TRUE(draw({.frames = 10, .step_every = 10, .cells = 6}).drawn);
  const int without = Picture(file("deformation.png")).count(is_arrow);
  EXPECT_GT(with_force, 1500);
  EXPECT_EQ(without, 0);
}

// A region is seen through the body that hides it; without regions there is none.
TEST_F(DrawRenderTest, ShowsRegions) {
  const auto is_purple = [](const Colour& c) { return c[2] - c[1] > 15 && c[0] - c[1] > 10; };
  ASSERT_TRUE(draw({}).drawn);
  const int without = Picture(file("deformation.png")).count(is_purple);
  ASSERT_TRUE(draw({.lump = true}).drawn);
  EXPECT_GT(Picture(file("deformation.png")).count(is_purple), without + 800);
}

TEST_F(DrawRenderTest, LateFramesAreRed) {
  sample::write_run(scratch_.path(), {});
  ASSERT_TRUE(redraw().drawn);
  const Picture in_time(file("latency.png"));
  std::ifstream in(file("frames.csv"));
  std::ostringstream out;
  for (std::string line; std::getline(in, line);) {
    // frame,born,latency,load,deadline,1,… → 0
    if (const auto verdict = line.find(",1,"); line[0] >= '0' && line[0] <= '9')
      line[verdict + 1] = '0';
    out << line << '\n';
  }
  in.close();
  std::ofstream(file("frames.csv")) << out.str();
  ASSERT_TRUE(redraw().drawn);
  const Picture late(file("latency.png"));
  EXPECT_GT(late.count(is_red), in_time.count(is_red) + 1000);
  EXPECT_LT(late.count(is_blue), in_time.count(is_blue) - 1000);
}

// In the lower right, bars of the frames in time and none of another colour.
TEST_F(DrawRenderTest, ShowsHowOftenWhichLatency) {
  ASSERT_TRUE(draw({}).drawn);
  const Picture picture(file("latency.png"));
  int blue = 0;
  for (int y = 75; y < 268; ++y)
    for (int x = 890; x < 1365; ++x) blue += is_blue(picture.at(x, y)) ? 1 : 0;
  EXPECT_GT(blue, 300);
}

TEST_F(DrawRenderTest, ARunWithoutDeformationGetsItsLatencyAlone) {
  sample::write_run(scratch_.path(), {});
  std::filesystem::remove(file("deformation.pvd"));
  const auto outcome = redraw();
  EXPECT_TRUE(outcome.drawn) << outcome.reason;
  EXPECT_EQ(outcome.files, std::vector<std::string>{"latency.png"});
  EXPECT_FALSE(std::filesystem::exists(file("deformation.png")));
}

// A swing from frame to frame fills the force's panel though a pixel is many frames wide.
TEST_F(DrawRenderTest, AClosedLoopThatOscillatesLooksDifferent) {
  const Picture still = loop_picture({});
  EXPECT_EQ(still.width(), 1400);
  EXPECT_EQ(still.height(), 1000);
  EXPECT_GT(still.colours(), 100u);
  EXPECT_GT(loop_picture({.swing_N = 3.0}).count(is_orange), still.count(is_orange) + 100000);
}

TEST_F(DrawRenderTest, WhereTheLoopFeedsEnergyInIsMarked) {
  EXPECT_LT(loop_picture({}).count(is_pink), 2000);
  EXPECT_GT(loop_picture({.absorbed_J = -0.002}).count(is_pink), 100000);
}

TEST_F(DrawRenderTest, FurtherProbesHaveLinesOfTheirOwn) {
  const int one = loop_picture({}).count(is_blue);
  EXPECT_GT(loop_picture({.probes = 2}).count(is_blue), one + 500);
}

TEST_F(DrawRenderTest, AMapFillsWhatIsStable) {
  const auto draw_map = [&](double stiffness) {
    std::ofstream(file("map.csv"))
        << "# Sample\ndamping_N_s_m,stiffness_max_N_m,stiffness_linear_N_m,stiffness_passive_N_m\n"
        << "0,0,2000,0\n2," << stiffness << ",2000,500\n";
    return draw_stability_map(file("map.csv"), file("map.png"), tools());
  };
  const auto outcome = draw_map(2000);
  ASSERT_TRUE(outcome.drawn) << outcome.reason;
  EXPECT_EQ(outcome.files, std::vector<std::string>{"map.png"});
  const Picture picture(file("map.png"));
  EXPECT_GT(picture.colours(), 50u);
  EXPECT_GT(picture.count(is_orange), 1000);
  const double filled = picture.count(is_pale_blue);
  ASSERT_TRUE(draw_map(1000).drawn);
  EXPECT_NEAR(Picture(file("map.png")).count(is_pale_blue) / filled, 0.5, 0.05);
}

TEST_F(DrawRenderTest, AFitHasTheModelOverTheLogAndWhatIsLeftOver) {
  const auto draw = [&](double left) {
    std::ofstream csv(file("fit.csv"));
    csv << "# Sample\nx,observed,modelled,residual\n";
    for (int i = 0; i < 200; ++i) {
      const double model = std::sin(0.05 * i);
      const double rest = i % 2 == 0 ? left : -left;
      csv << 0.01 * i << ',' << model + rest << ',' << model << ',' << rest << '\n';
    }
    csv.close();
    return draw_fit(file("fit.csv"), file("fit.png"), {"time (s)", "force", "N"}, tools());
  };
  const auto outcome = draw(0.01);
  ASSERT_TRUE(outcome.drawn) << outcome.reason;
  EXPECT_EQ(outcome.files, std::vector<std::string>{"fit.png"});
  const Picture picture(file("fit.png"));
  EXPECT_GT(picture.count(is_orange), 1000);
  EXPECT_GT(picture.count(is_blue), 5000);
  ASSERT_TRUE(draw(0).drawn);
  EXPECT_LT(Picture(file("fit.png")).count(is_blue), 5000);
}

TEST_F(DrawRenderTest, BrokenResultsAreAReason) {
  sample::write_run(scratch_.path(), {});
  std::ofstream(file("summary.json")) << "{";
  const auto outcome = redraw();
  EXPECT_FALSE(outcome.drawn);
  EXPECT_EQ(outcome.reason,
            "summary.json: not well-formed JSON: deformation.png and latency.png were not drawn");
}

}  // namespace
}  // namespace hvp::results::draw_render_test
