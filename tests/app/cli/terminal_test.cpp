#include <string>

#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// A user's words may hold what a terminal would obey. None of it arrives there.
namespace hvp::cli::terminal_test {
namespace {

using ::testing::HasSubstr;

bool has_control_characters(const std::string& text) {
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte < 0x20U && c != '\n') || byte == 0x7FU) return true;
  }
  // C1 in UTF-8.
  for (std::size_t at = text.find('\xc2'); at != std::string::npos;
       at = text.find('\xc2', at + 1)) {
    if (at + 1 < text.size() && static_cast<unsigned char>(text[at + 1]) < 0xA0U) return true;
  }
  return false;
}

constexpr const char* kTitle = R"(title = "red \u001b[31m, home \u009b1;1H, bell \u0007\nnext")";

std::string titled_scene() {
  const std::string scene = kSmallScene;
  return kTitle + scene.substr(scene.find('\n'));
}

TEST(Terminal, ATitleIsShownInOneLineAndNotObeyed) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", titled_scene());
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"run", "s.toml", "--out", "out"},
        {"explain", "s.toml"},
        {"device", "s.toml"},
        {"device", "s.toml", "--json"}}) {
    const Ended ended = hvp(place.path(), arguments);
    EXPECT_LE(ended.status, 1) << ended.err;
    EXPECT_FALSE(has_control_characters(ended.out)) << arguments[0];
    if (arguments.back() != "--json") {
      EXPECT_EQ(lines(ended.out).at(0), "red \\u001b[31m, home \\u009b1;1H, bell \\u0007\\nnext");
    }
  }
}

TEST(Terminal, AFileNameIsShownAndNotObeyed) {
  const ScratchDirectory place;
  const std::string odd =
      "a\x1b[31m\x9b"
      "b\n";
  write(place.path() / (odd + ".toml"), kSmallScene);
  const Ended ended = hvp(place.path(), {"run", odd + ".toml", "--out", odd + "out"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_FALSE(has_control_characters(ended.out));
  EXPECT_THAT(ended.out, HasSubstr("a\\u001b[31m\\x9bb"));
  const Ended mesh = hvp(place.path(), {"mesh", "box", "--nodes", "60", "--out", odd + ".vtu"});
  EXPECT_EQ(mesh.status, 0) << mesh.err;
  EXPECT_FALSE(has_control_characters(mesh.out));
}

TEST(Terminal, AnErrorIsOneLineAndNotObeyed) {
  const ScratchDirectory place;
  const std::string odd =
      "a\x1b[31m\x9b"
      "b\n";
  write(place.path() / (odd + ".toml"), "frames = \"\\u001b[2J\"");
  write(place.path() / "file", "");
  write(place.path() / (odd + ".stl"), "solid \x1b[31m\nvertex\nendsolid");
  write(place.path() / (odd + ".mtx"), "\x1b[31m");
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"run", odd + ".toml"},
        {"run", odd},
        {odd},
        {"run", "s.toml", "--" + odd},
        {"run", scenario("thesis.toml").string(), "--set", odd + "=3"},
        {"run", scenario("thesis-static.toml").string(), "--out", "file/" + odd},
        {"mesh", odd + ".stl"},
        {"mesh", "box", "--size", odd},
        {"mesh", "box", "--out", odd},
        {"export", scenario("thesis-static.toml").string(), "--out", "file/" + odd},
        {"solve", "--matrix", odd, "--rhs", "b"},
        {"solve", "--matrix", odd + ".mtx", "--rhs", "b"},
        {"solve", "--matrix", "file", "--rhs", "b", "--kernel", odd}}) {
    const Ended ended = hvp(place.path(), arguments);
    EXPECT_EQ(ended.status, 2) << ended.err;
    EXPECT_EQ(lines(ended.err).size(), 1U) << ended.err;
    EXPECT_FALSE(has_control_characters(ended.err)) << ended.err;
  }
}

}  // namespace
}  // namespace hvp::cli::terminal_test
