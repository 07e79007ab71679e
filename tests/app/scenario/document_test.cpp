#include "app/scenario/document.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/app/scenario/read_toy.h"
#include "tests/app/scratch_directory.h"

namespace hvp::scenario::document_test {
namespace {

std::string load_error(const std::filesystem::path& file) {
  try {
    Document::load(file);
  } catch (const SourceError& error) {
    return error.what();
  }
  return "no error";
}

std::string parse_error(const std::string& text) {
  try {
    Document::parse(text, "x.toml");
  } catch (const SourceError& error) {
    return error.what();
  }
  return "no error";
}

// A folder of its own that goes with the test.
class Files : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }

  ScratchDirectory place_;
  const std::filesystem::path folder_ = place_.path();
};

TEST_F(Files, AreRead) {
  EXPECT_NE(Document::load(write("a.toml", "title = 'x'")).root().find("title"), nullptr);
}

TEST_F(Files, ThatCannotBeReadAreReportedInOneLine) {
  const auto name = [&](const char* file) { return (folder_ / file).string(); };
  EXPECT_EQ(load_error(name("none.toml")),
            name("none.toml") + ": no such file: expected a scenario");
  EXPECT_EQ(load_error(folder_), folder_.string() + ": is a folder: expected a scenario");
  EXPECT_EQ(load_error(write("empty.toml", "")),
            name("empty.toml") + ": is empty: expected TOML tables");
  EXPECT_EQ(load_error(write("blank.toml", "\n# only a comment\n")),
            name("blank.toml") + ": is empty: expected TOML tables");
  EXPECT_EQ(load_error(write("large.toml", std::string((1U << 20U) + 1, '\n'))),
            name("large.toml") + ": is too large: expected at most 1 MiB");
  EXPECT_EQ(load_error("/dev/zero"),
            "/dev/zero: is a device: expected a scenario in a regular file");
  EXPECT_EQ(load_error(write("file", "x") / "a.toml"),
            name("file/a.toml") + ": no such file: expected a scenario");
  std::filesystem::create_symlink("loop.toml", folder_ / "loop.toml");
  EXPECT_EQ(load_error(name("loop.toml")),
            name("loop.toml") + ": cannot be read: Too many levels of symbolic links");
}

TEST(Syntax, ErrorsHaveLineAndColumn) {
  EXPECT_EQ(parse_error("title = 'x'\nbudget = = 3").substr(0, 25), "x.toml:2:10: TOML syntax:");
  EXPECT_EQ(parse_error("a = 1\na = 2").substr(0, 8), "x.toml:2");
  EXPECT_EQ(parse_error("[a]\nb=1\n[a]\nc=2").substr(0, 8), "x.toml:3");
  EXPECT_EQ(parse_error("a = \"\xff\xfe\"").substr(0, 8), "x.toml:1");
  EXPECT_EQ(parse_error(std::string("a = 1\0b", 7)).substr(0, 8), "x.toml:1");
  EXPECT_EQ(parse_error("\xff\xfe"
                        "a\0=\0")
                .substr(0, 8),
            "x.toml:1");
}

TEST(Syntax, ErrorsAreOneLine) {
  for (const char* text :
       {"a = \"\n\"", "a\n=\n", "\"a\nb\" = 3", "a = [1,\n\n\n", "\r", "a = '\x01'"}) {
    const std::string error = parse_error(text);
    EXPECT_NE(error, "no error");
    EXPECT_TRUE(std::all_of(error.begin(), error.end(), [](unsigned char c) { return c >= 0x20; }))
        << error;
  }
}

// toml++ 3.3 does not survive the first one without our guard.
TEST(Syntax, RefusesControlCharacters) {
  EXPECT_EQ(parse_error(std::string("a = 1\n[\0]", 9)),
            "x.toml:2:2: TOML syntax: control character U+0000");
  EXPECT_EQ(parse_error("# \x7f"), "x.toml:1:3: TOML syntax: control character U+007F");
  EXPECT_EQ(parse_error("a = 1\rb = 2"), "x.toml:1:6: TOML syntax: control character U+000D");
  EXPECT_EQ(parse_error("a = 1\r\nb = '\t'\r\n"), "no error");
}

// In toml++ 3.3 these characters, where a blank could be, were undefined behaviour.
TEST(Syntax, PlacesUnquotedLettersBeyondAscii) {
  EXPECT_EQ(parse_error("a = 1\nb = 2 \u00b5s").substr(0, 23), "x.toml:2:7: TOML syntax");
  EXPECT_EQ(parse_error("a = 1\n\u00e9 = 2").substr(0, 23), "x.toml:2:1: TOML syntax");
  EXPECT_EQ(parse_error("a = \"\"\"b\\\n\u00e9\"\"\""), "no error");
}

// Each of these nests as deep as a file of 1 MiB can.
TEST(Syntax, RefusesNestingBombs) {
  const auto times = [](const std::string& text, std::size_t count) {
    std::string result;
    for (std::size_t i = 0; i < count; ++i) result += text;
    return result;
  };
  const std::string nested = "tables and lists nested more than 32 deep";
  const std::string keys = "keys more than 32 deep";
  EXPECT_EQ(parse_error("a = " + times("[", 500000)), "x.toml:1:37: TOML syntax: " + nested);
  EXPECT_EQ(parse_error("a = " + times("{a=", 300000)), "x.toml:1:101: TOML syntax: " + nested);
  EXPECT_EQ(parse_error(times("a.", 500000) + "a = 1"), "x.toml:1:64: TOML syntax: " + keys);
  EXPECT_EQ(parse_error("b=1\n[" + times("a.", 500000) + "a]"),
            "x.toml:2:65: TOML syntax: " + keys);
  EXPECT_EQ(parse_error("[" + times("'a' . ", 100000) + "a]").substr(0, 6), "x.toml");
}

TEST(Syntax, IgnoresBracketsAndDotsInStringsAndComments) {
  const std::string many(100, '[');
  const std::string dots(100, '.');
  EXPECT_EQ(parse_error("a = '" + many + dots + "' # " + many + dots + "\nb = \"\\\"" + many +
                        "\"\nc = '''" + many + "\n'" + many + "'''\nd = \"\"\"" + many +
                        "\\\"\"\"" + many + "\"\"\"\"\ne = [[[1.5]]]\n"),
            "no error");
}

TEST(Locate, FindsTheKeyOrTheNearestTable) {
  const Document document = Document::parse(
      "title = 'x'\n[object]\ndensity = '1 kg/m3'\n[object.mesh]\nnodes = 500\n[[contacts]]\n"
      "a = 1\n[[contacts]]\nb = 2\n",
      "scenes/x.toml", {"solver.iterations=3", "budget={period='1 s'}"});
  EXPECT_EQ(document.locate("object.mesh.nodes"), "scenes/x.toml:5: object.mesh.nodes: ");
  EXPECT_EQ(document.locate("object.mesh.shape"), "scenes/x.toml:4: object.mesh.shape: ");
  EXPECT_EQ(document.locate("object.material.young"), "scenes/x.toml:2: object.material.young: ");
  EXPECT_EQ(document.locate("host.jitter"), "scenes/x.toml:1: host.jitter: ");
  EXPECT_EQ(document.locate("contacts[1].b"), "scenes/x.toml:9: contacts[1].b: ");
  EXPECT_EQ(document.locate("contacts[1].a"), "scenes/x.toml:8: contacts[1].a: ");
  EXPECT_EQ(document.locate("contacts[2].a"), "scenes/x.toml:6: contacts[2].a: ");
  EXPECT_EQ(document.locate("solver.iterations"), "--set solver.iterations=3: ");
  EXPECT_EQ(document.locate("budget.period"), "--set budget={period='1 s'}: budget.period: ");
  EXPECT_EQ(document.locate(""), "scenes/x.toml: ");
}

TEST(Complete, AddsThePlaceOnce) {
  const Document document = Document::parse("[object.mesh]\nnodes = 5", "x.toml");
  const SourceError error =
      document.complete(InputError("object.mesh.nodes", "5 cannot be reached"));
  EXPECT_STREQ(error.what(), "x.toml:2: object.mesh.nodes: 5 cannot be reached");
  EXPECT_EQ(error.key(), "object.mesh.nodes");
  EXPECT_STREQ(document.complete(error).what(), error.what());
  EXPECT_STREQ(document.complete(InputError("two\nlines")).what(), "x.toml: two\\nlines");
}

}  // namespace
}  // namespace hvp::scenario::document_test
