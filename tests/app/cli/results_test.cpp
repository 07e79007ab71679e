#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include <gmock/gmock.h>

#include "models/files/csv.h"
#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// What is in the result files, and that they agree with each other.
namespace hvp::cli::results_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

// Exact: the files have microseconds with six decimals.
std::int64_t picoseconds(double us) { return std::llround(us * 1e6); }

class Results : public ::testing::Test {
 protected:
  Ended run(std::vector<std::string> more = {}, int status = 0) {
    write(place_.path() / "s.toml", kSmallScene);
    more.insert(more.begin(), {"run", "s.toml", "--out", "out"});
    Ended ended = hvp(place_.path(), more);
    EXPECT_EQ(ended.status, status) << ended.err;
    return ended;
  }
  std::string file(const std::string& name) const { return read(place_.path() / "out" / name); }
  json summary() const { return json::parse(file("summary.json")); }

  // A column of frames.csv.
  std::vector<std::string> column(const std::string& name) const {
    const std::vector<std::string> text = lines(file("frames.csv"));
    const auto head = files::csv_cells(text.at(0));
    const auto at = std::find(head.begin(), head.end(), name) - head.begin();
    std::vector<std::string> values;
    for (std::size_t i = 1; i < text.size(); ++i) {
      values.emplace_back(files::csv_cells(text[i]).at(static_cast<std::size_t>(at)));
    }
    return values;
  }

 private:
  ScratchDirectory place_;
};

TEST_F(Results, SummaryHasWhatTheDesignPromises) {
  run();
  const json s = summary();
  for (const char* key : {"period_us", "worst_us", "p50_us", "p99_us"}) {
    EXPECT_TRUE(s.at("deadline").at(key).is_number_float()) << key;
  }
  EXPECT_TRUE(s.at("deadline").at("misses").is_number_integer());
  EXPECT_EQ(s.at("deadline").at("frames"), 40);
  EXPECT_EQ(s.at("deadline").at("period_us"), 2000.0);
  for (const char* key : {"displacement_rel", "force_rel", "displacement_rel_quantised"}) {
    EXPECT_TRUE(s.at("accuracy").at(key).is_number_float()) << key;
    EXPECT_GT(s.at("accuracy").at(key), 0) << key;
  }
  EXPECT_TRUE(s.at("stability").at("saturations").is_number_integer());
  EXPECT_TRUE(s.at("stability").at("breakdowns").is_number_integer());
  EXPECT_TRUE(s.at("stability").at("flags").is_array());
  std::set<std::string> types;
  for (const json& r : s.at("resources")) {
    types.insert(r.at("type").get<std::string>());
    EXPECT_LE(r.at("used"), r.at("available"));
  }
  EXPECT_EQ(types,
            (std::set<std::string>{"M512", "M4K", "M-RAM", "multipliers", "logic", "registers"}));
  EXPECT_EQ(s.at("effects"), json({"reference"}));
  EXPECT_EQ(s.at("fidelity"), json({{"accelerator", "loosely-timed"},
                                    {"bus", "loosely-timed"},
                                    {"host", "loosely-timed"},
                                    {"numbers", "fixed"}}));
}

TEST_F(Results, AccuracyIsNullWithoutAReference) {
  const Ended ended = run({"--set", "reference=false"});
  const json s = summary();
  for (const char* key : {"displacement_rel", "force_rel", "displacement_rel_quantised"}) {
    EXPECT_TRUE(s.at("accuracy").at(key).is_null()) << key;
  }
  EXPECT_EQ(s.at("effects"), json::array());
  EXPECT_THAT(ended.out, HasSubstr("not measured: add [reference]"));
}

TEST_F(Results, EffectsAreThoseOfTheScenario) {
  run({"--set", "dynamics=true", "--set", "loads.gravity=true"});
  EXPECT_EQ(summary().at("effects"), json({"loads.gravity", "dynamics", "reference"}));
}

TEST_F(Results, AttributionSumsToTheWorstLatency) {
  run();
  const json s = summary();
  std::int64_t exact = 0;
  double sum = 0;
  for (const json& line : s.at("attribution")) {
    exact += picoseconds(line.at("us"));
    sum += line.at("us").get<double>();
  }
  const double worst = s.at("deadline").at("worst_us");
  EXPECT_EQ(exact, picoseconds(worst));
  EXPECT_NEAR(sum, worst, 1e-12 * worst);
}

TEST_F(Results, FramesAgreeWithTheSummary) {
  run();
  const json s = summary();
  const std::vector<std::string> frame = column("frame");
  const std::vector<std::string> latency = column("latency_us");
  ASSERT_EQ(frame.size(), 40U);
  double worst = 0;
  std::vector<double> sorted;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    EXPECT_EQ(frame[i], std::to_string(i));
    EXPECT_EQ(std::stod(column("born_us")[i]), 2000.0 * static_cast<double>(i));
    sorted.push_back(std::stod(latency[i]));
    worst = std::max(worst, sorted.back());
  }
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(s.at("deadline").at("worst_us"), worst);
  EXPECT_EQ(s.at("deadline").at("p50_us"), sorted[19]);  // the 20th of 40
  EXPECT_EQ(s.at("deadline").at("p99_us"), sorted[39]);
  EXPECT_EQ(std::stod(latency[s.at("deadline").at("worst_frame")]), worst);
  EXPECT_EQ(s.at("deadline").at("misses"), 0);
  for (const std::string& in_time : column("in_time")) EXPECT_EQ(in_time, "1");
}

TEST_F(Results, TheShareInContactIsThatOfTheFrames) {
  const Ended ended = run({"--set", "frames=300"});
  const std::vector<std::string> nodes = column("contact_node");
  const auto touching = std::ranges::count_if(nodes, [](const auto& node) { return node != "-1"; });
  EXPECT_GT(touching, 0);
  EXPECT_LT(touching, 300);
  EXPECT_EQ(summary().at("contact").at("share"), static_cast<double>(touching) / 300);
  EXPECT_THAT(ended.out, HasSubstr(" of the frames\n"));
}

TEST_F(Results, PartsOfAFrameSumToItsLatency) {
  run();
  const std::vector<std::string> latency = column("latency_us");
  std::vector<std::int64_t> sum(latency.size());
  double all = 0;
  for (const char* part : {"host_us", "bus_us", "fpga_us", "daq_us", "device_us"}) {
    const std::vector<std::string> time = column(part);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += picoseconds(std::stod(time[i]));
  }
  for (std::size_t i = 0; i < sum.size(); ++i) {
    EXPECT_EQ(sum[i], picoseconds(std::stod(latency[i]))) << "frame " << i;
    all += static_cast<double>(sum[i]);
  }
  const json s = summary().at("latency");
  EXPECT_NEAR(s.at("mean_us").get<double>(), 1e-6 * all / 40, 1e-9);
}

TEST_F(Results, LatencyFiguresAgreeWithTheFrames) {
  const Ended ended = run({"--details"});
  const json s = summary();
  const json& latency = s.at("latency");
  std::vector<std::int64_t> sorted;
  for (const std::string& us : column("latency_us")) sorted.push_back(picoseconds(std::stod(us)));
  std::int64_t change = 0;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    change = std::max(change, std::abs(sorted[i] - sorted[i - 1]));
  }
  EXPECT_EQ(picoseconds(s.at("jitter").at("frame_to_frame").at("worst_us")), change);
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(picoseconds(latency.at("best_us")), sorted.front());
  // Percentiles are exact: the 36th of 40 is the smallest that 90 % do not exceed.
  EXPECT_EQ(picoseconds(latency.at("percentiles").at("p50_us")), sorted[19]);
  EXPECT_EQ(picoseconds(latency.at("percentiles").at("p90_us")), sorted[35]);
  EXPECT_EQ(picoseconds(latency.at("percentiles").at("p99_us")), sorted[39]);
  EXPECT_EQ(picoseconds(latency.at("percentiles").at("p99_9_us")), sorted[39]);
  EXPECT_EQ(latency.at("percentiles").at("worst_us"), s.at("deadline").at("worst_us"));
  for (const json& bin : latency.at("histogram")) {
    const auto in_bin = std::count_if(sorted.begin(), sorted.end(), [&bin](std::int64_t t) {
      return t >= picoseconds(bin.at("from_us")) && t < picoseconds(bin.at("below_us"));
    });
    EXPECT_EQ(bin.at("frames"), in_bin);
    EXPECT_GT(in_bin, 0);
  }
  double share = 0;
  double mean = 0;
  for (const json& part : latency.at("by_part")) {
    share += part.at("share").get<double>();
    mean += part.at("mean_us").get<double>();
    EXPECT_THAT(ended.out, HasSubstr("\n  " + part.at("part").get<std::string>() + "  "));
    std::int64_t counted = 0;
    for (const json& bin : part.at("histogram")) counted += bin.at("frames").get<std::int64_t>();
    EXPECT_EQ(counted, summary().at("deadline").at("frames"));
  }
  EXPECT_NEAR(share, 1, 1e-12);
  EXPECT_NEAR(mean, latency.at("mean_us").get<double>(), 1e-9);
  // A start, an acknowledgement and a latch of the position a frame at least.
  const json& transactions = latency.at("by_transaction");
  const auto writes = std::find_if(transactions.begin(), transactions.end(),
                                   [](const json& t) { return t.at("transaction") == "write"; });
  ASSERT_NE(writes, transactions.end());
  EXPECT_GE(writes->at("count"), 3 * 40);
  std::int64_t counted = 0;
  for (const json& octave : writes->at("octaves")) {
    counted += octave.at("count").get<std::int64_t>();
  }
  EXPECT_EQ(writes->at("count"), counted);
  EXPECT_THAT(ended.out, HasSubstr("\n  bus block read "));
}

TEST_F(Results, UtilisationOfTheBusIsWithoutTheSetUp) {
  const Ended ended = run();
  const json bus = summary().at("bus");
  const json& used = bus.at("utilisation");
  ASSERT_EQ(used.at("by_initiator").size(), 1U);
  const json& processor = used.at("by_initiator")[0];
  EXPECT_EQ(processor.at("initiator"), "processor");
  EXPECT_EQ(processor.at("share"), used.at("share"));
  EXPECT_GT(used.at("share"), 0);
  EXPECT_LE(used.at("share"), used.at("worst_frame_share"));
  EXPECT_LT(used.at("worst_frame_share"), 1);
  // K is loaded before.
  EXPECT_LT(processor.at("bytes"), bus.at("bytes"));
  EXPECT_LT(processor.at("busy_us"), bus.at("busy_us"));
  EXPECT_THAT(ended.out, HasSubstr("; processor "));
}

TEST_F(Results, ALinkIsUsedInBothDirectionsAndByItsBoard) {
  const Ended bus_only = run();
  EXPECT_FALSE(summary().at("bus").contains("pcie"));
  EXPECT_THAT(bus_only.out, Not(HasSubstr("link taken")));
  const Ended ended = run({"--set", "bus.pcie.lanes=4", "--set", "transfer.method=dma"});
  const json used = summary().at("bus").at("pcie").at("utilisation");
  for (const char* direction : {"to_board", "to_host"}) {
    EXPECT_GT(used.at(direction).at("share"), 0) << direction;
    EXPECT_GE(used.at(direction).at("worst_frame_share"), used.at(direction).at("share"));
    EXPECT_LT(used.at(direction).at("worst_frame_share"), 1);
  }
  ASSERT_EQ(used.at("by_initiator").size(), 2U);
  EXPECT_EQ(used.at("by_initiator")[0].at("initiator"), "processor");
  EXPECT_EQ(used.at("by_initiator")[1].at("initiator"), "board");
  // b down and u up is more than the doorbells.
  EXPECT_GT(used.at("by_initiator")[1].at("bytes"), used.at("by_initiator")[0].at("bytes"));
  EXPECT_THAT(ended.out, HasSubstr("link taken     to the board "));
}

TEST_F(Results, FramesSayWhichWereLate) {
  // A period between the shortest and the longest frame of a run that was in time.
  run();
  std::vector<double> frames;
  for (const std::string& us : column("latency_us")) frames.push_back(std::stod(us));
  const auto [shortest, longest] = std::minmax_element(frames.begin(), frames.end());
  const double period = std::floor(1e6 * (*shortest + *longest) / 2) / 1e6;
  ASSERT_LT(*shortest, period);
  // As long as before in all, or the probe would not have come as far.
  run({"--set", "frames=800", "--set", "budget.period=" + std::to_string(period) + " us"}, 1);
  const std::vector<std::string> latency = column("latency_us");
  const std::vector<std::string> in_time = column("in_time");
  std::int64_t late = 0;
  for (std::size_t i = 0; i < latency.size(); ++i) {
    const bool held = std::stod(latency[i]) <= period;
    EXPECT_EQ(in_time[i], held ? "1" : "0") << "frame " << i;
    if (!held) ++late;
  }
  EXPECT_EQ(summary().at("deadline").at("misses"),
            late + summary().at("deadline").at("skipped_ticks").get<std::int64_t>());
  EXPECT_GT(late, 0);
}

TEST_F(Results, RegisterLogHasEveryAccess) {
  run({"--trace-registers"});
  const std::vector<std::string> log = lines(file("registers.log"));
  ASSERT_FALSE(log.empty());
  EXPECT_EQ(log[0], "# time_us access register bytes first_word outcome");
  std::int64_t bytes = 0;
  std::int64_t starts = 0;
  double time = 0;
  for (std::size_t i = 1; i < log.size(); ++i) {
    std::istringstream stream(log[i]);
    double at = 0;
    std::int64_t size = 0;
    std::string access, name, word, outcome, none;
    ASSERT_TRUE(stream >> at >> access >> name >> size >> word >> outcome) << log[i];
    EXPECT_FALSE(stream >> none) << log[i];
    EXPECT_GE(at, time);
    time = at;
    EXPECT_EQ(outcome, "ok");
    if (name == "CONTROL" && access == "write" && (std::stoul(word, nullptr, 16) & 1U) != 0U) {
      ++starts;
    }
    bytes += size;
  }
  // A solve a frame; the rest of the bus' traffic is the DAQ board's: a command, three words of
  // position and three of force a frame.
  EXPECT_GE(starts, 40);
  EXPECT_EQ(bytes + 40 * (4 + 12 + 12), summary().at("bus").at("bytes").get<std::int64_t>());
}

// How often a wire of a VCD file changes to this value, or to any.
std::int64_t changes(const std::string& vcd, const std::string& wire, const std::string& value) {
  std::string code;
  std::int64_t count = 0;
  std::istringstream stream(vcd);
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line);
    std::string kind, type, width, id, name;
    if (words >> kind >> type >> width >> id >> name && kind == "$var" && name == wire) code = id;
    if (code.empty() || line.size() != 1 + code.size() || !line.ends_with(code)) continue;
    if (value.empty() || line.starts_with(value)) ++count;
  }
  return count;
}

TEST_F(Results, TheWaveformHasEveryAccessAndInterrupt) {
  run({"--trace-registers"});
  const std::string vcd = file("registers.vcd");
  const auto accesses = static_cast<std::int64_t>(lines(file("registers.log")).size()) - 1;
  // Its first value is dumped too; the access with which the run ends is not.
  EXPECT_EQ(changes(vcd, "toggle", ""), 1 + accesses - 1);
  // One for K's check and one a solve.
  EXPECT_EQ(changes(vcd, "interrupt", "1"), 41);
  EXPECT_EQ(changes(vcd, "interrupt", "0"), 41 + 1);
  EXPECT_EQ(changes(vcd, "refused", "1"), 0);
  run({"--trace-registers"});
  EXPECT_TRUE(file("registers.vcd") == vcd);
}

// dma.log, the lane of trace.json and the waveform have the same transactions at the same times.
TEST_F(Results, EachTransferOfTheBoardsIsInTheLogTheLaneAndTheWaveform) {
  const std::vector<std::string> dma = {"--set", "transfer.method=dma", "--set",
                                        "transfer.notification=msi", "--trace-dma"};
  run(dma);
  EXPECT_THROW(file("registers.log"), std::runtime_error);
  const std::string log = file("dma.log");
  std::vector<std::string> drawn = {"# began_us ended_us job access what address bytes"};
  const json trace = json::parse(file("trace.json"));
  for (const json& event : trace.at("traceEvents")) {
    if (event.at("pid") != 3 || event.at("ph") != "X") continue;
    const json& arguments = event.at("args");
    std::ostringstream line;
    line << picoseconds(event.at("ts")) << ' '
         << picoseconds(event.at("ts")) + picoseconds(event.at("dur")) << ' '
         << arguments.at("frame") << ' ' << arguments.at("access").get<std::string>() << ' '
         << event.at("name").get<std::string>() << ' ' << arguments.at("address").get<std::string>()
         << ' ' << arguments.at("bytes");
    EXPECT_EQ(arguments.at("answered"), true);
    drawn.push_back(line.str());
  }
  const std::vector<std::string> logged = lines(log);
  ASSERT_EQ(drawn.size(), logged.size());
  // Two descriptors at once, b, U, the record and a message a frame, and one for K's check.
  EXPECT_GE(drawn.size(), 1U + 5U * 40U);
  for (std::size_t i = 1; i < logged.size(); ++i) {
    std::istringstream stream(logged[i]);
    double began = 0;
    double ended = 0;
    std::string rest;
    stream >> began >> ended;
    std::getline(stream, rest);
    const std::string times =
        std::to_string(picoseconds(began)) + ' ' + std::to_string(picoseconds(ended));
    EXPECT_EQ((times + rest).substr(0, drawn[i].size()), drawn[i]);
  }
  std::vector<std::string> both = dma;
  both.emplace_back("--trace-registers");
  run(both);
  EXPECT_EQ(file("dma.log"), log);
  // Its first value is dumped too.
  EXPECT_EQ(changes(file("registers.vcd"), "transfer_toggle", ""),
            1 + static_cast<std::int64_t>(logged.size()) - 1);
}

TEST_F(Results, ABoardThatIsNoMasterHasNoTransfersToTrace) {
  const Ended ended = run({"--trace-dma"});
  EXPECT_THAT(ended.err, HasSubstr("--trace-dma: the board moves nothing by itself"));
  EXPECT_THROW(file("dma.log"), std::runtime_error);
}

TEST_F(Results, NothingIsLoggedUnlessAskedFor) {
  run();
  EXPECT_THROW(file("registers.log"), std::runtime_error);
  EXPECT_THROW(file("registers.vcd"), std::runtime_error);
}

// A log that is no terminal gets no progress, so that --quiet changes nothing there.
TEST_F(Results, ProgressStaysOutOfFiles) {
  EXPECT_EQ(run().err, "");
  EXPECT_EQ(run({"--quiet"}).err, "");
}

TEST_F(Results, TerminalAndSummaryAgree) {
  const Ended ended = run();
  EXPECT_THAT(ended.out, HasSubstr("force in time  PASS: worst "));
  EXPECT_THAT(ended.out, HasSubstr("Time         40 ticks at 500 Hz"));
  EXPECT_THAT(ended.out, HasSubstr("no flags"));
  EXPECT_EQ(summary().at("stability").at("flags"), json::array());
}

// A force of 10^8 N is no motor's. No word of the solver is to blame, and none would help.
TEST_F(Results, AClampedForceIsAFlagOfItsOwn) {
  const Ended ended = run({"--set", "object.material.young_modulus=1000 GPa"});
  const json stability = summary().at("stability");
  EXPECT_EQ(stability.at("clamped_words"), 0);
  EXPECT_GT(stability.at("clamped_forces"), 0);
  EXPECT_EQ(stability.at("flags"), json({"force-clamped"}));
  EXPECT_TRUE(summary().at("remedy").is_null());
  EXPECT_THAT(ended.out, Not(HasSubstr("in time  PASS")));
}

TEST_F(Results, ClampedWordsAreAFlagAndNoPass) {
  const Ended ended = run({"--set", "solver.displacement_range=0.1 mm"});
  EXPECT_GT(summary().at("stability").at("clamped_words"), 0);
  EXPECT_EQ(summary().at("stability").at("clamped_forces"), 0);
  EXPECT_THAT(summary().at("stability").at("flags").dump(), HasSubstr("range-exceeded"));
  EXPECT_THAT(ended.out, Not(HasSubstr("in time  PASS")));
}

// Nobody asked for a reference: the words alone have to tell.
TEST_F(Results, ALoadThatVanishesInItsWordsIsAFlagAndNoPass) {
  const Ended ended =
      run({"--set", "reference=false", "--set", "solver.static_shift=31", "--set", "frames=100"});
  EXPECT_THAT(summary().at("stability").at("flags").dump(), HasSubstr("stagnation"));
  EXPECT_THAT(ended.out, Not(HasSubstr("in time  PASS")));
}

TEST_F(Results, WrappedWordsAreCountedAndNoPass) {
  const Ended ended =
      run({"--set", "solver.overflow=wrap", "--set", "solver.displacement_range=1 mm"});
  EXPECT_GT(summary().at("stability").at("wraps"), 0);
  EXPECT_THAT(summary().at("stability").at("flags").dump(), HasSubstr("wrapped"));
  EXPECT_THAT(ended.out, HasSubstr("wrapped word"));
  EXPECT_THAT(ended.out, Not(HasSubstr("in time  PASS")));
}

TEST_F(Results, AKernelThatDoesNotExistIsRefusedBeforeTheRun) {
  ASSERT_EQ(setenv("HVP_KERNEL", "abacus", 1), 0);
  const Ended ended = run({}, 2);
  ASSERT_EQ(unsetenv("HVP_KERNEL"), 0);
  EXPECT_THAT(ended.err, HasSubstr("HVP_KERNEL: a kernel \"abacus\" does not exist"));
  EXPECT_EQ(lines(ended.err).size(), 1U);
}

TEST_F(Results, ABodyThatIsNotTouchedHasNothingToCompare) {
  const Ended ended = run({"--set", "frames=1"});
  EXPECT_THAT(ended.out,
              HasSubstr("nothing to compare: no frame that was compared had the body displaced"));
  EXPECT_TRUE(summary().at("accuracy").at("displacement_rel").is_null());
}

// What the other master moves can let a retried read end sooner than alone.
TEST(SharedBus, AttributionOfDelayedReadsAddsUp) {
  const ScratchDirectory place;
  const Ended ended = hvp(
      place.path(), {"run", scenario("shared-bus.toml").string(), "--out", "a", "--set",
                     "bus.protocol.delayed_read_clocks=16", "--set", "bus.traffic.direction=read",
                     "--set", "frames=20", "--set", "output.pictures=false"});
  EXPECT_LE(ended.status, 1) << ended.err;
  const json s = json::parse(read(place.path() / "a/summary.json"));
  double sum = 0;
  for (const json& line : s.at("attribution")) sum += line.at("us").get<double>();
  EXPECT_NEAR(sum, s.at("deadline").at("worst_us").get<double>(), 1e-9);
}

}  // namespace
}  // namespace hvp::cli::results_test
