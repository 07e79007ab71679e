#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// What a run says of the engine that timed its board.
namespace hvp::cli::engine_test {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class Engine : public ::testing::Test {
 protected:
  Ended run(const std::string& level, std::vector<std::string> more = {}, int status = 0) {
    write(place_.path() / "s.toml", kSmallScene);
    std::vector<std::string> all = {"run",   "s.toml",   "--out",
                                    "out",   "--set",    "fidelity.accelerator=" + level,
                                    "--set", "frames=12"};
    all.insert(all.end(), more.begin(), more.end());
    Ended ended = hvp(place_.path(), all);
    EXPECT_EQ(ended.status, status) << ended.err;
    return ended;
  }
  std::filesystem::path place() const { return place_.path(); }
  std::filesystem::path folder() const { return place_.path() / "out"; }
  std::string file(const std::string& name) const { return read(folder() / name); }
  json board() const { return json::parse(file("summary.json")).at("accelerator"); }

 private:
  ScratchDirectory place_;
};

std::vector<std::string> with_waveform(const std::string& first, const std::string& frames) {
  return {"--set", "output.waveform.first_frame=" + first, "--set",
          "output.waveform.frames=" + frames};
}

#ifdef HVP_ENGINE_TESTBENCH
// A simulator that knows the port's record alone comes to the same clocks and words.
TEST_F(Engine, ATestbenchReplaysThePort) {
  const auto replayed = [this](const std::string& record) {
    write(place() / "port.txt", record);
    const std::string command = std::string(HVP_ENGINE_TESTBENCH) +
                                " +port=" + (place() / "port.txt").string() + " > " +
                                (place() / "told").string() + " 2>&1";
    const int status = std::system(command.c_str());
    return std::pair(status, read(place() / "told"));
  };
  run("rtl", {"--set", "output.engine_port.frames=8", "--set", "solver.method=jacobi-pcg", "--set",
              "accelerator.device=EP2S180"});
  EXPECT_THAT(file("engine-port.txt"), HasSubstr("\ni "));  // P⁻¹
  EXPECT_THAT(replayed(file("engine-port.txt")).second,
              HasSubstr(" values compared, 0 of them different"));
  run("rtl", {"--set", "output.engine_port.frames=8"});
  const std::string record = file("engine-port.txt");
  for (const char* kind : {"\ns ", "\nc ", "\ne ", "\nx ", "\nw "}) {
    EXPECT_THAT(record, HasSubstr(kind));
  }
  const auto [status, told] = replayed(record);
  EXPECT_EQ(status, 0) << told;
  EXPECT_THAT(told, HasSubstr(" values compared, 0 of them different"));
  // One word of x.
  std::string other = record;
  const std::size_t at = other.rfind("\nx ");
  const std::size_t word = other.find(' ', at + 3) + 1;
  other[word] = other[word] == '1' ? '2' : '1';
  const auto [fails, says] = replayed(other);
  EXPECT_NE(fails, 0);
  EXPECT_THAT(says, HasSubstr("a word of x is "));
  EXPECT_THAT(says, HasSubstr(" 1 of them different"));
  // A record that is cut off, whole lines of it, and one that has lost a line.
  const std::size_t end = record.rfind("\nz ") + 1;
  EXPECT_NE(replayed(record.substr(0, end)).first, 0);
  EXPECT_THAT(replayed(record.substr(0, end)).second, HasSubstr("the record has no end"));
  EXPECT_THAT(replayed(record.substr(record.find('\n') + 1)).second,
              HasSubstr("lines before its end"));
  // A file that ends within a line.
  EXPECT_THAT(replayed("w 0 1").second, HasSubstr("line 1: a letter and three numbers"));
}
// What helps is tried at another level, which has no such port.
TEST_F(Engine, RemediesAreTriedWithoutTheRecordOfThePort) {
  const Ended ended =
      hvp(place(), {"run", scenario("thesis.toml").string(), "--out", "out", "--set", "frames=2",
                    "--set", "fidelity.accelerator=rtl", "--set", "output.engine_port.frames=1"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("what would help --set "));
  EXPECT_THAT(ended.out, Not(HasSubstr("does not fit  --set output.engine_port")));
}
#endif

TEST_F(Engine, PhasesOfTheLongestSolveSumToItsClocks) {
  for (const char* level : {"approximately-timed", "cycle-accurate"}) {
    SCOPED_TRACE(level);
    const Ended ended = run(level);
    EXPECT_THAT(ended.out, HasSubstr(std::string("Engine       ") + level));
    const json a = board();
    std::int64_t engine = 0, closed_form = 0;
    for (const json& phase : a.at("phases")) {
      engine += phase.at("cycles").get<std::int64_t>();
      closed_form += phase.at("closed_form_cycles").get<std::int64_t>();
      // Frames are further apart than the copy of U takes.
      if (phase.at("phase") == "wait") {
        EXPECT_EQ(phase.at("cycles"), 0);
      }
      // Two divisions of 68 clocks an iteration.
      if (phase.at("phase") == "divisions") {
        EXPECT_EQ(phase.at("cycles"), 20 * 2 * 68);
      }
    }
    EXPECT_EQ(engine, a.at("solve_cycles"));
    EXPECT_EQ(closed_form, a.at("closed_form_cycles"));
    const auto deviation = a.at("closed_form_deviation_rel").get<double>();
    EXPECT_NEAR(deviation, static_cast<double>(closed_form - engine) / static_cast<double>(engine),
                1e-12);
    EXPECT_LE(std::abs(deviation), 0.03);
    // The solve of the worst frame is what the ledger saw.
    const json summary = json::parse(file("summary.json"));
    for (const json& line : summary.at("attribution")) {
      if (line.at("phase") == "solve") {
        EXPECT_EQ(line.at("us"), a.at("solve_us"));
      }
    }
  }
  const Ended loose = run("loosely-timed");
  EXPECT_THAT(loose.out, Not(HasSubstr("Engine")));
  EXPECT_FALSE(board().contains("phases"));
}

TEST_F(Engine, InSystemVerilogHasJacobisPreconditioner) {
  const std::vector<std::string> jacobi = {"--set", "solver.method=jacobi-pcg", "--set",
                                           "accelerator.device=EP2S180"};
  run("cycle-accurate", jacobi);
  const std::string frames = file("frames.csv");
  std::vector<std::string> rtl = {
      "run", "s.toml", "--out", "out", "--set", "fidelity.accelerator=rtl", "--set", "frames=12"};
  rtl.insert(rtl.end(), jacobi.begin(), jacobi.end());
  const Ended ended = hvp(place(), rtl);
  if (ended.status == 2) {
    EXPECT_THAT(ended.err, HasSubstr("fidelity.accelerator=rtl: this build has no engine in"));
    GTEST_SKIP() << "the RTL engine is left out of this build";
  }
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(file("frames.csv"), frames);
}

// Each of the solves is compared, so that a run to the end is one without a difference.
TEST_F(Engine, InSystemVerilogGivesTheBytesOfTheCycleAccurateOne) {
  // But for the level's name, and what a run takes in wall-clock time.
  const auto results = [this] {
    std::map<std::string, std::string> files;
    for (const std::string& name : names(folder())) {
      if (name == "performance.json") continue;
      std::string bytes = file(name);
      for (std::size_t at = 0; (at = bytes.find("cycle-accurate", at)) != std::string::npos;) {
        bytes.replace(at, std::string_view("cycle-accurate").size(), "rtl");
      }
      files[name] = std::move(bytes);
    }
    return files;
  };
  run("cycle-accurate");
  const std::map<std::string, std::string> expected = results();
  const Ended ended = hvp(place(), {"run", "s.toml", "--out", "out", "--set",
                                    "fidelity.accelerator=rtl", "--set", "frames=12"});
  if (ended.status == 2) {
    EXPECT_THAT(ended.err, HasSubstr("fidelity.accelerator=rtl: this build has no engine in"));
    GTEST_SKIP() << "the RTL engine is left out of this build";
  }
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("Engine       rtl"));
  EXPECT_THAT(ended.out,
              HasSubstr("RTL          as the cycle-accurate engine: 12 solves, 0 aborted"));
  EXPECT_THAT(ended.out, Not(HasSubstr("; 0 updates of the matrix"))) << "no contact came";
  const std::map<std::string, std::string> found = results();
  ASSERT_EQ(found.size(), expected.size());
  for (const auto& [name, bytes] : expected) EXPECT_TRUE(found.at(name) == bytes) << name;
  // What it is not built for is refused by the key that says it.
  const std::pair<const char*, const char*> refused[] = {
      {"accelerator.package=17", "at the level rtl at most 16 was expected"},
      {"accelerator.pipeline_clocks=15", "at the level rtl at least 19 was expected"},
      {"solver.scalar_bits=128", "at the level rtl 64 was expected"},
      {"solver.overflow=wrap", "at the level rtl \"saturate\" was expected"}};
  for (const auto& [set, reason] : refused) {
    SCOPED_TRACE(set);
    const Ended wrong = run("rtl", {"--set", set}, 2);
    EXPECT_THAT(wrong.err, StartsWith(std::string("--set ") + set));
    EXPECT_THAT(wrong.err, HasSubstr(reason));
  }
}

// A size is translated by ./hvp rtl: the program says which, and what else there is to do.
TEST_F(Engine, InSystemVerilogHasTheSizesThatWereAskedFor) {
  run("cycle-accurate");
  std::filesystem::remove_all(folder());
  const Ended there = hvp(place(), {"rtl", "s.toml"});
  if (there.status == 2) {
    EXPECT_THAT(there.err, HasSubstr("this build has no engine in"));
    GTEST_SKIP() << "the RTL engine is left out of this build";
  }
  EXPECT_EQ(there.status, 0) << there.err;
  EXPECT_THAT(there.out, HasSubstr("Partitions 5 "));
  EXPECT_EQ(hvp(place(), {"rtl", "s.toml", "--cmake"}).out, "");

  const std::vector<std::string> larger = {
      "--set", "accelerator.partitions=7", "--set", "solver.vector_bits=19",
      "--set", "solver.scaling_step=3",    "--set", "solver.static_shift=17",
      "--set", "accelerator.clock=99 MHz", "--set", "accelerator.device=EP2S180"};
  const auto with = [&](std::vector<std::string> words) {
    words.insert(words.end(), larger.begin(), larger.end());
    return hvp(place(), words);
  };
  const Ended other = with({"rtl", "s.toml"});
  EXPECT_EQ(other.status, 1) << other.err;
  EXPECT_THAT(other.out, HasSubstr("VectorBits 19 "));
  EXPECT_THAT(other.out, HasSubstr("DivisionClocks 82 StaticBits 5 "));
  EXPECT_THAT(with({"rtl", "s.toml", "--cmake"}).out,
              testing::MatchesRegex("hvp_scenario_size\\([a-z0-9_]+ MatrixBits .* VectorBits 19 .* "
                                    "Partitions 7 .*Preconditioner 0\\)\n"));
  const Ended refused = with({"run", "s.toml", "--set", "fidelity.accelerator=rtl"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, StartsWith("--set fidelity.accelerator=rtl: "));
  EXPECT_THAT(refused.err, HasSubstr("./hvp rtl s.toml --set fidelity.accelerator=rtl --set "
                                     "accelerator.partitions=7"));
  EXPECT_THAT(refused.err, HasSubstr("--set 'accelerator.clock=99 MHz'"));
  EXPECT_EQ(lines(refused.err).size(), 1U);
  EXPECT_THAT(names(place()), Not(Contains("out")));
  // What a run would refuse is not translated.
  for (const char* const wrong :
       {"host.solver=cholesky", "accelerator.matrix_storage=symmetric",
        "accelerator.several.devices=2", "accelerator.package=17", "accelerator.device=EP2S15"}) {
    const Ended ended = hvp(place(), {"rtl", "s.toml", "--cmake", "--set", wrong});
    EXPECT_EQ(ended.status, 2) << wrong;
    EXPECT_EQ(lines(ended.err).size(), 1U) << wrong;
    EXPECT_EQ(ended.out, "") << wrong;
  }
}

TEST_F(Engine, AWaveformIsThereForWhoAsksAndChangesNothingElse) {
  run("cycle-accurate");
  EXPECT_THAT(names(folder()), Not(Contains("engine.vcd")));
  const std::string frames = file("frames.csv");
  const std::string trace = file("trace.json");
  run("cycle-accurate", with_waveform("3", "2"));
  EXPECT_EQ(file("frames.csv"), frames);
  EXPECT_EQ(file("trace.json"), trace);
  EXPECT_THAT(names(folder()), Contains("engine.vcd"));
  EXPECT_THAT(names(folder()), Not(Contains("engine.part.vcd")));
  const json summary = json::parse(file("summary.json"));
  EXPECT_THAT(summary.at("effects"), Contains("output.waveform"));

  const std::string first = file("engine.vcd");
  EXPECT_THAT(first, HasSubstr("z_r_value"));
  // A second run has the same bytes, and no date that could differ.
  const std::size_t date = first.find("$date") + 5;
  const std::string dated = first.substr(date, first.find("$end") - date);
  EXPECT_EQ(dated.find_first_not_of(" \n"), std::string::npos) << dated;
  run("cycle-accurate", with_waveform("3", "2"));
  EXPECT_TRUE(file("engine.vcd") == first);
  // Twice the frames, and nothing of the ones before and after.
  run("cycle-accurate", with_waveform("3", "4"));
  EXPECT_GT(file("engine.vcd").size(), first.size() * 3 / 2);

  // What an earlier run left is not this run's.
  write(folder() / "engine.part.vcd", "half a file");
  run("cycle-accurate");
  EXPECT_THAT(names(folder()), Not(Contains("engine.vcd")));
  EXPECT_THAT(names(folder()), Not(Contains("engine.part.vcd")));
}

// Beside engine.vcd, which is the one of the cycle-accurate engine.
TEST_F(Engine, InSystemVerilogHasAWaveformOfItsOwn) {
  std::vector<std::string> shown = with_waveform("3", "2");
  shown.insert(shown.end(), {"--set", "output.remedies=false", "--set", "output.pictures=false"});
  run("cycle-accurate", shown);
  const std::string vcd = file("engine.vcd");
  EXPECT_THAT(names(folder()), Not(Contains("engine.fst")));
  const auto at_rtl = [&] {
    std::vector<std::string> all = {
        "run", "s.toml", "--out", "out", "--set", "fidelity.accelerator=rtl", "--set", "frames=12"};
    all.insert(all.end(), shown.begin(), shown.end());
    return hvp(place(), all);
  };
  const Ended ended = at_rtl();
  if (ended.status == 2) {
    EXPECT_THAT(ended.err, HasSubstr("this build has no engine in SystemVerilog"));
    GTEST_SKIP() << "the RTL engine is left out of this build";
  }
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(file("engine.vcd") == vcd);
  const std::string fst = file("engine.fst");
  EXPECT_GT(fst.size(), 10'000U);
  EXPECT_THAT(names(folder()), Not(Contains("engine.part.fst")));
  // What only looks at the scenario leaves no file.
  hvp(place(), {"explain", "s.toml", "--set", "fidelity.accelerator=rtl", "--set",
                "output.waveform.frames=2"});
  EXPECT_THAT(names(place()), testing::UnorderedElementsAre("out", "s.toml"));
  // A second run has the same bytes.
  at_rtl();
  EXPECT_TRUE(file("engine.fst") == fst);
  run("cycle-accurate");
  EXPECT_THAT(names(folder()), Not(Contains("engine.fst")));
}

TEST_F(Engine, AWaveformThatCannotBeIsRefusedByName) {
  for (const char* level : {"untimed", "loosely-timed", "approximately-timed"}) {
    const Ended ended = run(level, with_waveform("3", "1"), 2);
    EXPECT_THAT(ended.err, HasSubstr("output.waveform"));
    EXPECT_THAT(ended.err,
                HasSubstr("expected fidelity.accelerator = \"cycle-accurate\" or \"rtl\", found"));
    EXPECT_EQ(lines(ended.err).size(), 1U);
  }
  EXPECT_THAT(run("cycle-accurate", with_waveform("12", "1"), 2).err,
              HasSubstr("output.waveform.first_frame"));
}

}  // namespace
}  // namespace hvp::cli::engine_test
