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
// along its critical path, and the file keeps to its bound.
namespace hvp::cli {
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
    // "bus", "bus waits", "bus 2" are lanes of the bus.
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
    if (event.at("ph") != "X") continue;
    const std::int64_t start = picoseconds(event.at("ts"));
    found[event.at("args").at("frame")].push_back({start, start + picoseconds(event.at("dur")),
                                                   event.at("tid"), event.at("cat"),
                                                   event.at("args").at("critical")});
  }
  return found;
}

// From the birth to the motor without a gap, an arrow at every slice of the critical path.
void expect_flow_along_the_path(const json& events, std::int64_t period) {
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
      const std::int64_t frame = picoseconds(event.at("ts")) / period;
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
    std::int64_t at = frame * period;
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
    expect_flow_along_the_path(all, picoseconds(summary().at("deadline").at("period_us")));
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
  for (const std::string method : {"bursts", "write-combined-io", "dma"}) {
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
}  // namespace hvp::cli
