// Frames of the whole platform: when each part works, to the picosecond.
#include <algorithm>
#include <array>
#include <stdexcept>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/vp/expected_frame.h"
#include "tests/vp/expected_time.h"
#include "tests/vp/path_of.h"
#include "tests/vp/small_scene.h"
#include "vp/platform.h"

namespace hvp::vp::frame_test {
namespace {

using test::compute;
using test::kNs;
using test::kUs;
using test::pci_write;
using test::Simulated;
using test::SmallScene;

constexpr int kUnknowns = SmallScene::kUnknowns;

int blocks_of(const SmallScene& scene, int mesh_node) {
  const fixed::QuantisedMatrix& k = scene.computation.board().matrix();
  const auto row = static_cast<std::size_t>(scene.body.active_index(mesh_node));
  return k.row_begin[row + 1] - k.row_begin[row];
}

Picoseconds constrain_time(const SmallScene& scene, int mesh_node) {
  const fixed::QuantisedMatrix& k = scene.computation.board().matrix();
  const auto row = static_cast<std::size_t>(scene.body.active_index(mesh_node));
  std::int64_t clocks = 20;
  for (int i = k.row_begin[row]; i < k.row_begin[row + 1]; ++i) {
    const auto other = static_cast<std::size_t>(k.column[static_cast<std::size_t>(i)]);
    clocks += test::packages(k.row_begin[other + 1] - k.row_begin[other]);
  }
  return pci_write(16) + pci_write(4) + clocks * test::kBoardClock;
}

void expect_sums(const Simulated& run) {
  for (std::size_t n = 0; n < run.log.frames.size(); ++n) {
    const Frame& frame = run.log.frames[n];
    Picoseconds sum = 0;
    for (const SpanId id : run.log.paths[n]) {
      const Span& span = frame.spans[static_cast<std::size_t>(id)];
      sum += span.end - span.start;
    }
    EXPECT_EQ(sum, frame.latency()) << "frame " << n;
  }
}

TEST(Frame, WithoutContactTakesTheSumOfItsSteps) {
  SmallScene scene;
  const Simulated run(scene);
  const Picoseconds begin = run.platform.session().begin;
  EXPECT_EQ(begin, run.platform.servo().set_up_time());
  ASSERT_EQ(run.log.frames.size(), 10U);
  const Picoseconds expected = test::latency(scene, 0, 0);
  for (const Frame& frame : run.log.frames) {
    EXPECT_EQ(frame.born, begin + frame.number * 2'000 * kUs);
    EXPECT_EQ(frame.latency(), expected);
    // The output settles by itself; a static body needs no update.
    EXPECT_EQ(frame.work_done - frame.born, expected - 10 * kUs);
    EXPECT_EQ(frame.touch().contact.node, -1);
    EXPECT_EQ(frame.touch().force.norm(), 0);
    EXPECT_LE((frame.touch().tip - SmallScene::above(10e-3)).norm(), 1e-9);  // whole nanometres
  }
  expect_sums(run);
  EXPECT_TRUE(run.platform.verdict().force_in_time());
  EXPECT_TRUE(run.platform.verdict().load_held());
  EXPECT_EQ(run.platform.verdict().worst_latency(), expected);
}

TEST(Frame, ContactAddsTheUpdateOnceTheWayForAWhileAndTheColumnsInEachFrame) {
  SmallScene scene;
  scene.touch();
  scene.settings.frames = 30;
  const Simulated run(scene);
  const int blocks = blocks_of(scene, SmallScene::kTopNode);
  const Picoseconds update = constrain_time(scene, SmallScene::kTopNode);
  int touched = 0;
  for (const Frame& frame : run.log.frames) {
    const bool now = frame.touch().contact.node >= 0;
    EXPECT_EQ(frame.touch().contact.node, now ? SmallScene::kTopNode : -1);
    const Picoseconds expected = now ? test::latency(scene, touched == 0 ? update : 0, blocks,
                                                     test::hand_over_operations(scene, touched))
                                     : test::latency(scene);
    EXPECT_EQ(frame.latency(), expected) << "frame " << frame.number;
    if (now) ++touched;
  }
  // The node is where it is wanted before the run ends.
  EXPECT_GT(touched, 15);
  EXPECT_GT(run.log.frames.back().touch().force.norm(), 0);
  EXPECT_EQ(run.platform.servo().counts().contact_changes, 1);
  expect_sums(run);
}

TEST(Frame, NewmarkUpdateFollowsTheForceAndBelongsToTheLoad) {
  SmallScene scene({.dynamics = fem::Dynamics{}, .solver = {}});
  const Simulated run(scene);
  // Update 4 and predictors 12 operations an unknown; the right-hand side one product with K for
  // Rayleigh's stiffness part and two operations an unknown, and two with the lumped masses.
  const double operations =
      (4 + 12 + 2 + 2) * kUnknowns +
      18.0 * static_cast<double>(scene.computation.board().matrix().column.size());
  for (const Frame& frame : run.log.frames) {
    EXPECT_EQ(frame.latency(), test::latency(scene, 0, 0));
    EXPECT_EQ(frame.work_done - frame.born,
              test::latency(scene, 0, 0) - 10 * kUs + compute(operations));
  }
  expect_sums(run);
}

TEST(Frame, UntimedPartsLeaveNoTime) {
  SmallScene scene;
  scene.settings.fidelity = {Timing::untimed, Timing::untimed, Timing::untimed, Numbers::fixed};
  const Simulated run(scene);
  EXPECT_EQ(run.platform.session().begin, 0);
  for (const Frame& frame : run.log.frames) EXPECT_EQ(frame.latency(), (1 + 10) * kUs);  // the DAQ
  expect_sums(run);
}

// The slide's frames, simulated in a child process: AddressSanitizer does not follow an exception
// in a process whose stack SystemC's coroutines have switched, and this test throws often.
std::vector<Frame> frames_of_a_slide() {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) return {};
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    SmallScene scene({.dynamics = fem::Dynamics{}, .solver = {}});
    scene.slide(0.04);
    scene.settings.frames = 40;
    const Simulated run(scene);
    bool sent = run.platform.servo().counts().contact_changes >= 2;
    const auto send = [&](const void* data, std::size_t bytes) {
      sent = sent && write(ends[1], data, bytes) == static_cast<ssize_t>(bytes);
    };
    for (const Frame& frame : run.log.frames) {
      const std::size_t spans = frame.spans.size();
      send(&frame.born, sizeof(frame.born));
      send(&frame.force_at_motor, sizeof(frame.force_at_motor));
      send(&spans, sizeof(spans));
      send(frame.spans.data(), spans * sizeof(Span));
    }
    _exit(sent ? 0 : 1);
  }
  close(ends[1]);
  std::vector<Frame> frames;
  const auto receive = [&](void* data, std::size_t bytes) {
    auto* to = static_cast<char*>(data);
    while (bytes > 0) {
      const ssize_t n = read(ends[0], to, bytes);
      if (n <= 0) return false;
      to += n;
      bytes -= static_cast<std::size_t>(n);
    }
    return true;
  };
  for (Frame frame; receive(&frame.born, sizeof(frame.born)); frames.push_back(frame)) {
    std::size_t spans = 0;
    if (!receive(&frame.force_at_motor, sizeof(frame.force_at_motor)) ||
        !receive(&spans, sizeof(spans))) {
      break;
    }
    frame.spans.resize(spans);
    if (!receive(frame.spans.data(), spans * sizeof(Span))) break;
    frame.number = static_cast<std::int64_t>(frames.size());
  }
  close(ends[0]);
  int status = 1;
  waitpid(child, &status, 0);
  return status == 0 ? frames : std::vector<Frame>();
}

// Every span of every critical path of real frames, those with contact changes included: without
// it the chain has a gap.
TEST(Frame, DeletingAnySpanOfTheCriticalPathIsNoticed) {
  const std::vector<Frame> frames = frames_of_a_slide();
  ASSERT_EQ(frames.size(), 40U);
  int deleted = 0;
  for (const Frame& whole : frames) {
    for (const SpanId id : critical_path(whole)) {
      const Span gone = whole.spans[static_cast<std::size_t>(id)];
      if (gone.start == gone.end) continue;  // taking away nothing leaves the sum whole
      // As if it had never been written: what followed it follows its cause.
      Frame f = whole;
      f.spans.erase(f.spans.begin() + id);
      const auto renumbered = [&](SpanId cause) {
        if (cause == id) cause = gone.cause;
        return cause > id ? cause - 1 : cause;
      };
      for (Span& span : f.spans) span.cause = renumbered(span.cause);
      f.force_at_motor = renumbered(f.force_at_motor);
      EXPECT_THROW(critical_path(f), std::logic_error)
          << "frame " << whole.number << ", " << name(gone.part) << " " << name(gone.phase);
      ++deleted;
    }
  }
  EXPECT_GT(deleted, 40 * 15);
}

TEST(Frame, SolveIsOnThePathAndTheHostsWaitBesideIt) {
  SmallScene scene;
  const Simulated run(scene);
  const Frame& frame = run.log.frames.front();
  const auto on_path = [&](Phase phase) {
    return std::any_of(run.log.paths[0].begin(), run.log.paths[0].end(), [&](SpanId id) {
      return frame.spans[static_cast<std::size_t>(id)].phase == phase;
    });
  };
  EXPECT_TRUE(on_path(Phase::solve));
  EXPECT_FALSE(on_path(Phase::wait));
  const auto wait = std::find_if(frame.spans.begin(), frame.spans.end(),
                                 [](const Span& s) { return s.phase == Phase::wait; });
  ASSERT_NE(wait, frame.spans.end());
  EXPECT_EQ(wait->end - wait->start,
            test::solve_time(scene.computation.board().matrix().row_begin, 60));
}

TEST(Frame, ContactIsBetweenAPassAndAPeriodMoreOld) {
  SmallScene scene;
  scene.touch();
  scene.settings.frames = 60;
  const Simulated run(scene);
  const Picoseconds longest = run.platform.collision()->longest_pass();
  int in_contact = 0;
  for (const Frame& frame : run.log.frames) {
    if (frame.touch().contact.node < 0) continue;
    ++in_contact;
    // A pass draws for 10 ms; the next report arrives a period of 33 Hz after the last.
    EXPECT_GT(frame.contact_age, 10 * test::kMs);
    EXPECT_LE(frame.contact_age, 30'303'030'303 + longest);
  }
  EXPECT_GT(in_contact, 45);
}

TEST(Frame, DriverTakesTimeForEachWordThatItPacksAndUnpacks) {
  SmallScene scene;
  scene.settings.host.driver_word_s = 10e-9;
  const Simulated run(scene);
  SmallScene without;
  for (const Frame& frame : run.log.frames) {
    EXPECT_EQ(frame.latency(), test::latency(without) + 2 * SmallScene::kUnknowns * 10 * kNs);
  }
}

}  // namespace
}  // namespace hvp::vp::frame_test
