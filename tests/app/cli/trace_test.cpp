#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// trace.json, checked as a viewer reads it: lanes have names, slices nest, each frame's flow leads
// along its critical path, cores and buses have one user at a time and add up to what summary.json
// says of them, and the file keeps to its bound.
namespace hvp::cli::trace_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

struct Slice {
  std::int64_t start = 0;  // ps
  std::int64_t end = 0;
  std::int64_t tid = 0;
  std::string part;
  bool critical = false;
  std::string phase = {};
};

// Exact: the file has picoseconds in its decimals, and at most a tenth of one more.
std::int64_t picoseconds(const json& us) { return std::llround(us.get<double>() * 1e6); }

// As Perfetto's importer takes a number of microseconds (json_utils: the double times 1000,
// truncated).
std::int64_t perfetto_ns(const json& us) {
  return static_cast<std::int64_t>(us.get<double>() * 1000.0);
}

template <class Start, class Length>
void expect_nested(const json& events, const Start& start, const Length& length) {
  std::map<std::int64_t, std::vector<std::pair<std::int64_t, std::int64_t>>> lanes;
  for (const json& event : events) {
    if (event.at("ph") != "X") continue;
    const std::int64_t from = start(event.at("ts"));
    lanes[event.at("tid")].emplace_back(from, from + length(event.at("dur")));
  }
  for (auto& [lane, slices] : lanes) {
    std::stable_sort(slices.begin(), slices.end(), [](const auto& a, const auto& b) {
      return std::tuple(a.first, -a.second) < std::tuple(b.first, -b.second);
    });
    std::vector<std::int64_t> around;
    for (const auto& [from, end] : slices) {
      while (!around.empty() && around.back() <= from) around.pop_back();
      if (!around.empty()) {
        EXPECT_LE(end, around.back()) << "lane " << lane << " at " << from;
      }
      around.push_back(end);
    }
  }
}

void expect_named(const json& events) {
  std::map<std::int64_t, std::string> names;
  std::map<std::int64_t, std::int64_t> order;
  for (const json& event : events) {
    if (event.at("ph") != "M" || !event.contains("tid")) continue;
    if (event.at("name") == "thread_name") {
      EXPECT_TRUE(names.emplace(event.at("tid"), event.at("args").at("name")).second);
    } else {
      ASSERT_EQ(event.at("name"), "thread_sort_index");
      order[event.at("tid")] = event.at("args").at("sort_index");
    }
  }
  for (const json& event : events) {
    if (event.at("ph") != "X") continue;
    ASSERT_TRUE(names.contains(event.at("tid"))) << event;
    // "bus", "bus waits", "bus 2", "bus taken" are lanes of the bus.
    EXPECT_EQ(names[event.at("tid")].rfind(event.at("cat").get<std::string>(), 0), 0U) << event;
  }
  std::set<std::string> different;
  std::set<std::int64_t> positions;
  for (const auto& [tid, lane] : names) {
    different.insert(lane);
    positions.insert(order.at(tid));
  }
  EXPECT_EQ(different.size(), names.size());
  EXPECT_EQ(positions.size(), names.size());
  for (const char* part : {"host", "bus", "fpga", "daq", "device"}) {
    EXPECT_TRUE(different.contains(part)) << part;
  }
}

// The slice on the lane in which a viewer finds the flow event: the innermost that is open, where
// events of one time keep the order of the file.
using Sliced = std::map<std::int64_t, std::vector<Slice>>;  // by frame, in the file's order

Sliced slices_of(const json& events) {
  Sliced found;
  for (const json& event : events) {
    if (event.at("ph") != "X" || event.at("pid") != 1) continue;
    const std::int64_t start = picoseconds(event.at("ts"));
    found[event.at("args").at("frame")].push_back(
        {start, start + picoseconds(event.at("dur")), event.at("tid"), event.at("cat"),
         event.at("args").at("critical"), event.at("name")});
  }
  return found;
}

// From the birth to the motor without a gap, an arrow at every slice of the critical path.
void expect_flow_along_the_path(const json& events, std::int64_t begin, std::int64_t period) {
  std::map<std::int64_t, std::vector<const json*>> flows;
  std::map<std::int64_t, std::int64_t> latency;
  const json* before = nullptr;
  for (const json& event : events) {
    const std::string ph = event.at("ph");
    if (ph == "s" || ph == "t" || ph == "f") {
      flows[event.at("id")].push_back(&event);
      // Right behind its slice, so that it is bound to that one.
      ASSERT_NE(before, nullptr);
      EXPECT_EQ(before->at("ph"), "X");
      EXPECT_EQ(before->at("tid"), event.at("tid"));
      EXPECT_EQ(before->at("ts"), event.at("ts"));
      EXPECT_EQ(before->at("args").at("frame"), event.at("id"));
      EXPECT_EQ(before->at("args").at("critical"), true);
    }
    if (ph == "C") {
      const std::int64_t frame = (picoseconds(event.at("ts")) - begin) / period;
      latency[frame] = picoseconds(event.at("args").at("us"));
    }
    before = &event;
  }
  const Sliced slices = slices_of(events);
  ASSERT_FALSE(slices.empty());
  EXPECT_EQ(flows.size(), slices.size());
  for (const auto& [frame, all] : slices) {
    SCOPED_TRACE("frame " + std::to_string(frame));
    const std::vector<const json*>& flow = flows[frame];
    std::vector<Slice> path;
    std::copy_if(all.begin(), all.end(), std::back_inserter(path),
                 [](const Slice& s) { return s.critical; });
    ASSERT_EQ(flow.size(), path.size());
    ASSERT_GE(path.size(), 2U);
    std::int64_t sum = 0;
    std::int64_t at = begin + frame * period;
    for (std::size_t i = 0; i < path.size(); ++i) {
      EXPECT_EQ(flow[i]->at("ph"), i == 0 ? "s" : i + 1 == path.size() ? "f" : "t");
      EXPECT_EQ(picoseconds(flow[i]->at("ts")), path[i].start);
      EXPECT_EQ(flow[i]->at("tid"), path[i].tid);
      EXPECT_EQ(path[i].start, at);
      at = path[i].end;
      sum += path[i].end - path[i].start;
    }
    EXPECT_EQ(flow.back()->at("bp"), "e");
    EXPECT_EQ(path.front().part, "host");
    EXPECT_EQ(path.back().part, "device");
    EXPECT_EQ(sum, latency[frame]);
  }
}

class Trace : public ::testing::Test {
 protected:
  Ended run(const std::string& scene, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"run", scene, "--out", "out", "--set", "output.pictures=false"});
    Ended ended = hvp(place_.path(), more);
    EXPECT_LE(ended.status, 1) << ended.err;
    return ended;
  }
  Ended run_small(std::vector<std::string> more = {}) {
    write(place_.path() / "s.toml", kSmallScene);
    return run("s.toml", std::move(more));
  }
  std::string text() const { return read(place_.path() / "out/trace.json"); }
  json events() const { return json::parse(text()).at("traceEvents"); }
  json summary() const { return json::parse(read(place_.path() / "out/summary.json")); }
  void expect_sound() const {
    const json all = events();
    expect_nested(all, picoseconds, picoseconds);
    expect_nested(all, perfetto_ns, perfetto_ns);
    expect_named(all);
    expect_flow_along_the_path(all, picoseconds(summary().at("set_up_us")),
                               picoseconds(summary().at("deadline").at("period_us")));
  }

 private:
  ScratchDirectory place_;
};

int lanes_with(const json& events, const std::string& name) {
  return static_cast<int>(std::count_if(events.begin(), events.end(), [&name](const json& e) {
    return e.at("name") == "thread_name" && e.at("args").at("name") == name;
  }));
}

std::set<std::int64_t> frames_in(const json& events) {
  std::set<std::int64_t> frames;
  for (const auto& [frame, slices] : slices_of(events)) frames.insert(frame);
  return frames;
}

// What process 2 shows of cores and buses.
struct Taken {
  std::int64_t start = 0;
  std::int64_t end = 0;
  std::string what;
  std::string by;
  std::int64_t frame = -1;
};
using Resources = std::map<std::string, std::vector<Taken>>;  // by lane, in the order of time

Resources resources_of(const json& events) {
  std::map<std::int64_t, std::string> lanes;
  for (const json& event : events) {
    if (event.at("name") == "thread_name") lanes[event.at("tid")] = event.at("args").at("name");
  }
  Resources found;
  for (const json& event : events) {
    if (event.at("ph") != "X" || event.at("pid") != 2) continue;
    const std::int64_t start = picoseconds(event.at("ts"));
    const json& arguments = event.at("args");
    found[lanes.at(event.at("tid"))].push_back({start, start + picoseconds(event.at("dur")),
                                                event.at("name"), arguments.at("by"),
                                                arguments.value("frame", std::int64_t{-1})});
  }
  for (auto& [lane, taken] : found) std::ranges::sort(taken, {}, &Taken::start);
  return found;
}

struct Audit {
  explicit Audit(const json& events, const json& with)
      : resources(resources_of(events)), summary(with), begin(picoseconds(with.at("set_up_us"))) {}

  // From `since` on, of one user or of all.
  std::int64_t busy(const std::string& lane, std::int64_t since = 0,
                    const std::string& by = "") const {
    std::int64_t sum = 0;
    if (!resources.contains(lane)) return 0;
    for (const Taken& t : resources.at(lane)) {
      if (t.start >= since && (by.empty() || t.by == by)) sum += t.end - t.start;
    }
    return sum;
  }
  void expect_one_user_at_a_time() const {
    for (const auto& [lane, taken] : resources) {
      for (std::size_t i = 1; i < taken.size(); ++i) {
        ASSERT_LE(taken[i - 1].end, taken[i].start) << lane << ": " << taken[i].what;
      }
    }
  }
  void expect_use_of_the_bus() const {
    const json& bus = summary.at("bus");
    EXPECT_EQ(busy("bus taken"), picoseconds(bus.at("busy_us")));
    for (const json& use : bus.at("utilisation").at("by_initiator")) {
      EXPECT_EQ(busy("bus taken", begin, use.at("initiator")), picoseconds(use.at("busy_us")))
          << use;
    }
  }
  // Shares are of the loop's time, which a share of the bus tells: by_initiator has both.
  void expect_use_of_the_link() const {
    const json& utilisation = summary.at("bus").at("pcie").at("utilisation");
    const json& first = utilisation.at("by_initiator").front();
    const double time = first.at("busy_us").get<double>() * 1e6 / first.at("share").get<double>();
    for (const std::string side : {"board", "host"}) {
      const double share = utilisation.at("to_" + side).at("share");
      EXPECT_NEAR(static_cast<double>(busy("link to " + side, begin)), share * time, 1) << side;
    }
  }
  // In the loosely-timed run of a processor that waits, what frames did on the bus is what they had
  // of it, and what the board's node updates hold it for.
  void expect_frames_on_the_bus(const Sliced& frames) const {
    std::map<std::int64_t, std::int64_t> taken;
    for (const Taken& t : resources.at("bus taken")) taken[t.frame] += t.end - t.start;
    for (const auto& [frame, slices] : frames) {
      std::int64_t sum = 0;
      for (const Slice& s : slices) {
        if (s.part == "bus" || s.phase == "node update") sum += s.end - s.start;
      }
      EXPECT_EQ(sum, taken[frame]) << "frame " << frame;
    }
  }
  void expect_passes() const {
    std::int64_t passes = 0;
    std::int64_t longest = 0;
    for (const Taken& t : resources.at("core 1")) {
      EXPECT_EQ(t.what, "collision pass");
      ++passes;
      longest = std::max(longest, t.end - t.start);
    }
    EXPECT_EQ(passes, summary.at("contact").at("collision_passes"));
    EXPECT_EQ(longest, picoseconds(summary.at("contact").at("longest_pass_us")));
  }
  // Set-up is there from power-up until the loop begins.
  void expect_set_up() const {
    const std::vector<Taken>& core = resources.at("core 0");
    EXPECT_EQ(core.front().what, "set-up");
    EXPECT_EQ(core.front().start, 0);
    const auto first_frame = std::ranges::find(core, 0, &Taken::frame);
    ASSERT_NE(first_frame, core.end());
    EXPECT_EQ(first_frame->start, begin);
    ASSERT_NE(first_frame, core.begin());
    EXPECT_EQ(std::prev(first_frame)->end, begin);
  }

  Resources resources;
  json summary;
  std::int64_t begin;
};

class TraceAudit : public Trace {
 protected:
  Audit audit() const {
    Audit audit(events(), summary());
    audit.expect_one_user_at_a_time();
    audit.expect_use_of_the_bus();
    audit.expect_set_up();
    return audit;
  }
};

TEST_F(TraceAudit, OfFramesOnPci) {
  run_small();
  const Audit a = audit();
  a.expect_passes();
  a.expect_frames_on_the_bus(slices_of(events()));
}

TEST_F(TraceAudit, OfTheWaysToMoveData) {
  for (const std::string posted : {"", "bus.posted_writes.buffer_bytes=64"}) {
    for (const std::string method : {"bursts", "programmed-io", "write-combined-io", "dma"}) {
      SCOPED_TRACE(method + " " + posted);
      std::vector<std::string> keys = {"--set", "transfer.method=" + method};
      if (!posted.empty()) keys.insert(keys.end(), {"--set", posted});
      run_small(keys);
      audit().expect_passes();
      expect_sound();
    }
  }
}

TEST_F(TraceAudit, OfALinkOfTheBoardsOwn) {
  for (const std::string level : {"loosely-timed", "approximately-timed"}) {
    SCOPED_TRACE(level);
    run_small({"--set", "bus.pcie.lanes=4", "--set", "transfer.method=dma", "--set",
               "fidelity.bus=" + level});
    audit().expect_use_of_the_link();
  }
}

TEST_F(TraceAudit, OfOneCore) {
  run_small({"--set", "host.cores=1", "--set", "host.graphics.non_preemptible=100 us"});
  const Audit a = audit();
  EXPECT_FALSE(a.resources.contains("core 1"));
  EXPECT_GT(a.busy("core 0", 0, "collision process"), 0);
}

TEST_F(TraceAudit, OfABusThatIsShared) {
  run(scenario("shared-bus.toml").string(),
      {"--set", "frames=40", "--set", "bus.graphics_traffic.bytes=100000"});
  const Audit a = audit();
  EXPECT_GT(a.busy("bus taken", 0, "traffic"), 0);
  EXPECT_GT(a.busy("bus taken", 0, "graphics"), 0);
}

TEST_F(TraceAudit, OfAFaultyBoard) {
  // Boards that are set up again, and a bridge that is asked for what it has recorded.
  run(scenario("faulty-board.toml").string());
  audit();
  const json all = events();
  const auto lane = [&all](const std::string& phase) {
    std::set<std::string> parts;
    for (const json& e : all) {
      if (e.at("ph") == "X" && e.at("name") == phase) parts.insert(e.at("cat"));
    }
    return parts;
  };
  EXPECT_EQ(lane("bridge status"), (std::set<std::string>{"host"}));
}

// The frames that are drawn and no more: the run goes on for ten times as many.
TEST_F(TraceAudit, EndsWithTheFramesThatAreDrawn) {
  run_small({"--set", "output.trace_frames=4"});
  const Audit a(events(), summary());
  a.expect_one_user_at_a_time();
  const std::int64_t period = picoseconds(summary().at("deadline").at("period_us"));
  for (const auto& [lane, taken] : a.resources) {
    EXPECT_LT(taken.back().start, a.begin + 4 * period) << lane;
    if (lane == "core 1") continue;
    EXPECT_GT(taken.back().start, a.begin + 3 * period) << lane;
  }
}

// A word at a time, set-up has thousands of packets.
TEST_F(TraceAudit, OfSetUpThatIsLargerThanItsShareSaysSo) {
  run_small({"--set", "bus.pcie.lanes=1", "--set", "transfer.method=programmed-io", "--set",
             "output.trace_size=200 kB", "--set", "output.trace_frames=2"});
  expect_sound();
  const json all = events();
  const auto cut = std::ranges::find_if(
      all, [](const json& e) { return e.at("name") == "set-up is not drawn further"; });
  ASSERT_NE(cut, all.end());
  EXPECT_EQ(cut->at("ph"), "i");
  EXPECT_EQ(frames_in(all).size(), 2U) << "the frames have the other three quarters";
}

TEST_F(Trace, IsSound) {
  run_small();
  expect_sound();
  EXPECT_EQ(frames_in(events()).size(), 40U);
}

TEST_F(Trace, WithFramesThatOverlapIsSound) {
  run_small({"--set", "host.pipeline_depth=1"});
  expect_sound();
}

TEST_F(Trace, OfLateFramesIsSoundAndMarksThem) {
  // Frames of 0.09 ms at a period of 0.05: the release of every other one is delayed.
  run_small({"--set", "budget.period=50 us"});
  expect_sound();
  const json all = events();
  const auto marks =
      std::count_if(all.begin(), all.end(), [](const json& e) { return e.at("name") == "late"; });
  const auto late = std::count_if(all.begin(), all.end(), [](const json& e) {
    return e.at("ph") == "C" && picoseconds(e.at("args").at("us")) > 50'000'000;
  });
  EXPECT_EQ(marks, late);
  EXPECT_GT(marks, 0);
}

TEST_F(Trace, OfOneCoreAndAJitteryHostIsSound) {
  run(scenario("jittery-host.toml").string(), {"--set", "host.cores=1", "--set", "frames=300"});
  expect_sound();
}

TEST_F(Trace, OfASharedBusHasItsWaitsBesideIt) {
  run(scenario("shared-bus.toml").string(), {"--set", "frames=50"});
  expect_sound();
  const json all = events();
  const auto waits = std::count_if(all.begin(), all.end(), [](const json& e) {
    return e.at("ph") == "X" && e.at("name") == "arbitration" && e.at("tid") == 4000;
  });
  EXPECT_GT(waits, 0);
  EXPECT_EQ(lanes_with(all, "bus waits"), 1);
}

TEST_F(Trace, OfFramesByDmaIsSound) {
  for (const std::string notification : {"intx", "msi", "polling"}) {
    SCOPED_TRACE(notification);
    run_small({"--set", "transfer.method=dma", "--set", "transfer.notification=" + notification});
    expect_sound();
  }
}

TEST_F(Trace, OfPostedWritesIsSound) {
  for (const std::string method : {"bursts", "programmed-io", "dma"}) {
    SCOPED_TRACE(method);
    run_small({"--set", "bus.posted_writes.buffer_bytes=64", "--set", "transfer.method=" + method});
    expect_sound();
  }
}

TEST_F(Trace, OfALinkOfTheBoardsOwnIsSound) {
  for (const std::string method : {"programmed-io", "write-combined-io", "dma"}) {
    for (const std::string level : {"loosely-timed", "approximately-timed"}) {
      SCOPED_TRACE(method + ", " + level);
      run_small({"--set", "bus.pcie.lanes=4", "--set", "transfer.method=" + method, "--set",
                 "fidelity.bus=" + level});
      expect_sound();
    }
  }
}

// Two frames under way, each with posted work of its own: a part has more to show at once than one
// lane takes.
TEST_F(Trace, OfOverlappingFramesByDmaOverALinkIsSound) {
  for (const std::string period : {"2 ms", "60 us"}) {
    SCOPED_TRACE(period);
    run_small({"--set", "bus.pcie.lanes=4", "--set", "transfer.method=dma", "--set",
               "host.pipeline_depth=1", "--set", "budget.period=" + period});
    expect_sound();
  }
}

TEST_F(Trace, HasAsManyFramesAsWereAskedFor) {
  run_small({"--set", "output.trace_frames=3"});
  EXPECT_EQ(frames_in(events()), (std::set<std::int64_t>{0, 1, 2}));
  expect_sound();
}

TEST_F(Trace, WithoutFramesIsAnEmptyOne) {
  run_small({"--set", "output.trace_frames=0"});
  EXPECT_TRUE(frames_in(events()).empty());
  EXPECT_TRUE(resources_of(events()).empty());
  expect_named(events());
}

TEST_F(Trace, KeepsToItsBoundAndSaysSo) {
  const Ended whole = run_small();
  EXPECT_THAT(whole.out, Not(HasSubstr("trace.json ends")));
  const auto all = static_cast<std::int64_t>(text().size());
  for (const std::int64_t bound : {std::int64_t{10'000}, all / 2, all - 1}) {
    SCOPED_TRACE(bound);
    const Ended cut = run_small({"--set", "output.trace_size=" + std::to_string(bound) + " B"});
    EXPECT_LE(static_cast<std::int64_t>(text().size()), bound);
    // No frame is cut through, and no room for another one is left.
    expect_sound();
    const std::set<std::int64_t> frames = frames_in(events());
    const auto count = static_cast<std::int64_t>(frames.size());
    ASSERT_GT(count, 0);
    EXPECT_EQ(*frames.rbegin(), count - 1);
    EXPECT_GT(static_cast<std::int64_t>(text().size()) + 2 * all / 40, bound);
    EXPECT_THAT(cut.out, HasSubstr("trace.json ends before frame " + std::to_string(count) +
                                   ": output.trace_size is "));
    const json last = events().back();
    EXPECT_EQ(last.at("ph"), "i");
    EXPECT_THAT(last.at("name").get<std::string>(),
                HasSubstr("output.trace_size is " + std::to_string(bound) + " bytes"));
  }
}

TEST_F(Trace, BoundsThatHoldNothingAreRefused) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", kSmallScene);
  const Ended ended = hvp(place.path(), {"run", "s.toml", "--set", "output.trace_size=1 kB"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, HasSubstr("output.trace_size"));
  EXPECT_EQ(lines(ended.err).size(), 1U);
}

}  // namespace
}  // namespace hvp::cli::trace_test
