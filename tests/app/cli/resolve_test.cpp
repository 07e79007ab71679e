#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

namespace hvp::cli::resolve_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class Resolve : public ::testing::Test {
 protected:
  Resolve() { write(place_.path() / "s.toml", kSmallScene); }

  Ended with(std::vector<std::string> more) {
    more.insert(more.begin(), {"resolve", "s.toml"});
    return hvp(place_.path(), more);
  }
  // An answer a list of overrides.
  std::vector<json> each(const std::vector<std::vector<std::string>>& lists,
                         const std::vector<std::string>& more = {}) {
    std::string input;
    for (const auto& list : lists) input += json(list).dump() + '\n';
    std::vector<std::string> arguments = {"resolve", "s.toml", "--each"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Ended ended = hvp_reading(input, place_.path(), arguments);
    EXPECT_EQ(ended.status, 0) << ended.err;
    std::vector<json> answers;
    for (const std::string& line : lines(ended.out)) answers.push_back(json::parse(line));
    EXPECT_EQ(answers.size(), lists.size());
    return answers;
  }

  ScratchDirectory place_;
};

TEST_F(Resolve, PrintsTheFileThatARunWrites) {
  const std::vector<std::string> changes = {"--set", "frames=3", "--set", "budget.period=1 ms"};
  const Ended ended = with(changes);
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.err, "");
  EXPECT_EQ(names(place_.path()), std::vector<std::string>{"s.toml"});
  std::vector<std::string> run = {"run", "s.toml", "--out", "out"};
  run.insert(run.end(), changes.begin(), changes.end());
  ASSERT_LE(hvp(place_.path(), run).status, 1);
  EXPECT_EQ(ended.out, read(place_.path() / "out/scenario.resolved.toml"));
}

TEST_F(Resolve, OfWhatItPrintedIsTheSameText) {
  const std::string once = with({}).out;
  write(place_.path() / "again.toml", once);
  EXPECT_EQ(hvp(place_.path(), {"resolve", "again.toml"}).out, once);
}

TEST_F(Resolve, RefusesWhatARunRefuses) {
  const Ended ended = with({"--set", "bus.traffic=true"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_EQ(ended.out, "");
  EXPECT_EQ(ended.err, hvp(place_.path(), {"run", "s.toml", "--set", "bus.traffic=true"}).err);
}

TEST_F(Resolve, AnswersEachLine) {
  const std::vector<json> answers =
      each({{"frames=3"}, {"frames=none"}, {}, {"frames=4", "solver.iterations=5"}});
  EXPECT_THAT(answers.at(0).at("scenario").get<std::string>(), HasSubstr("\nframes = 3\n"));
  EXPECT_EQ(answers.at(1).at("error").get<std::string>() + '\n',
            hvp(place_.path(), {"run", "s.toml", "--set", "frames=none"}).err);
  EXPECT_FALSE(answers.at(1).contains("scenario"));
  EXPECT_EQ(answers.at(2).at("scenario"), with({}).out);
  EXPECT_THAT(answers.at(3).at("scenario").get<std::string>(), HasSubstr("\niterations = 5\n"));
}

TEST_F(Resolve, LaysALineOverTheOptions) {
  const std::vector<json> answers =
      each({{}, {"frames=4"}}, {"--set", "frames=3", "--set", "seed=7"});
  EXPECT_THAT(answers.at(0).at("scenario").get<std::string>(), HasSubstr("\nframes = 3\n"));
  EXPECT_THAT(answers.at(1).at("scenario").get<std::string>(), HasSubstr("\nframes = 4\n"));
  EXPECT_THAT(answers.at(1).at("scenario").get<std::string>(), HasSubstr("\nseed = 7\n"));
}

// A title with the changes in brackets would make a difference of every spelling.
TEST_F(Resolve, EqualSettingsAreEqualTexts) {
  const std::vector<json> answers =
      each({{"budget.period=1 ms"}, {"budget.period=0.001 s"}, {"budget={period='1000 us'}"}});
  EXPECT_EQ(answers.at(0), answers.at(1));
  EXPECT_EQ(answers.at(0), answers.at(2));
  EXPECT_THAT(answers.at(0).at("scenario").get<std::string>(),
              HasSubstr("\ntitle = \"A small box\"\n"));
}

TEST_F(Resolve, NamesTheFilesThatAreSimulatedToo) {
  write(place_.path() / "own.csv", "late_us\n1\n2\n");
  std::filesystem::create_directory(place_.path() / "sub");
  std::filesystem::copy(scenario("surfaces/bean.stl"), place_.path() / "sub/bean.stl");
  const std::vector<json> answers = each(
      {{"host.jitter={distribution='measured', samples='own.csv'}"},
       {"object.mesh={shape='surface', surface='sub/bean.stl', surface_unit='1 mm', nodes=200}"},
       {"host.jitter={distribution='measured', samples='none.csv'}"}});
  EXPECT_EQ(answers.at(0).at("files"),
            json::array({{{"key", "host.jitter.samples"}, {"path", "own.csv"}}}));
  EXPECT_EQ(answers.at(1).at("files"),
            json::array({{{"key", "object.mesh.surface"}, {"path", "sub/bean.stl"}}}));
  EXPECT_THAT(answers.at(1).at("scenario").get<std::string>(),
              HasSubstr("surface = \"scenario.resolved.stl\""));
  EXPECT_THAT(answers.at(2).at("error").get<std::string>(), HasSubstr("none.csv: no such file"));
}

TEST_F(Resolve, NamesADeviceOfTheUsersOwn) {
  const std::filesystem::path device = scenario("../devices/EP2S60.toml");
  std::filesystem::copy(device, place_.path() / "mine.toml");
  const std::vector<json> answers = each({{"accelerator.device=mine.toml"}});
  EXPECT_EQ(answers.at(0).at("files"),
            json::array({{{"key", "accelerator.device"}, {"path", "mine.toml"}}}));
}

// Somebody asks, reads the answer and asks on.
TEST_F(Resolve, AnswersBeforeTheNextLineIsThere) {
  const std::filesystem::path pipe = place_.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  Program program(place_.path(), {"resolve", "s.toml", "--each"}, pipe);
  std::ofstream questions(pipe);
  questions << "[]" << std::endl;
  while (!program.out().ends_with('\n') && !program.ended()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_TRUE(json::parse(program.out()).contains("scenario"));
  questions.close();
  EXPECT_EQ(program.wait().status, 0);
}

TEST_F(Resolve, RefusesALineThatIsNoListOfTexts) {
  for (const std::string wrong : {"", "frames=3", "{}", "[3]", "[[\"a=b\"]]", "[\"frames=3\"",
                                  "\"frames=3\"", "[\"\xff=1\"]"}) {
    const Ended ended =
        hvp_reading("[]\n" + wrong + "\n[]\n", place_.path(), {"resolve", "s.toml", "--each"});
    EXPECT_EQ(ended.status, 2) << wrong;
    EXPECT_EQ(lines(ended.out).size(), 1U) << wrong;
    EXPECT_EQ(lines(ended.err).size(), 1U) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr("line 2 of the standard input: expected a JSON array"));
  }
}

TEST_F(Resolve, RefusesALineOfMoreThanAMebibyte) {
  const Ended ended = hvp_reading("[\"" + std::string(1U << 20U, 'a') + "\"]\n", place_.path(),
                                  {"resolve", "s.toml", "--each"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, HasSubstr("line 1 of the standard input: "));
  EXPECT_THAT(ended.err, HasSubstr("found a line of more than 1 MiB"));
}

}  // namespace
}  // namespace hvp::cli::resolve_test
