// Frames of the whole platform by every way to move b and U: to the picosecond, with the same
// words.
#include "vp/host/transfer.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/vp/child_output.h"
#include "tests/vp/expected_frame.h"
#include "tests/vp/small_scene.h"
#include "vp/host/dma_memory.h"

namespace hvp::vp::transfer_test {
namespace {

using link::Notification;
using test::kNs;
using test::kUs;
using test::pci_read;
using test::pci_write;
using test::Simulated;
using test::SmallScene;
using Method = Transfer::Method;

constexpr int kBytes = 2 * SmallScene::kUnknowns;
constexpr int kWords = kBytes / 4;
constexpr Picoseconds kEngine = 200 * kNs;
constexpr Picoseconds kInterrupt = 5 * kUs;

// The board's bursts on PCI 32/33, without the processor's way.
Picoseconds board_write(int bytes) { return test::pci(bytes, 4, 0); }
Picoseconds board_read(int bytes) { return test::pci(bytes, 4 + 8, 0); }

Picoseconds solve_time(const SmallScene& scene) {
  return test::solve_time(scene.computation.board().matrix().row_begin, 60);
}
Picoseconds acknowledged() { return pci_read(4) + pci_write(4); }

// What is not b, the job, its end and U.
Picoseconds rest(const SmallScene& scene) {
  return test::latency(scene) - pci_write(kBytes) - pci_write(4) - solve_time(scene) - kInterrupt -
         acknowledged() - pci_read(kBytes);
}

// Between b in the driver and the doorbell's end, and from there to the record.
Picoseconds list_time(const SmallScene& scene) {
  return kEngine + board_read(64) + board_read(kBytes) + solve_time(scene) + kEngine +
         board_write(kBytes) + board_write(32);
}

Transfer transfer(Method method, Notification notification) {
  Transfer t;
  t.method = method;
  t.notification = notification;
  return t;
}

// All frames alike, each path without a gap, and so long.
void expect_frames(SmallScene& scene, const Transfer& t, Picoseconds expected) {
  scene.settings.transfer = t;
  const Simulated run(scene);
  ASSERT_EQ(run.log.frames.size(), 10U);
  for (std::size_t n = 0; n < run.log.frames.size(); ++n) {
    const Frame& frame = run.log.frames[n];
    EXPECT_EQ(frame.latency(), expected) << "frame " << n;
    EXPECT_TRUE(frame.solved());
    EXPECT_LE(frame.spans.size(), 32U);
    const auto solves =
        std::count_if(run.log.paths[n].begin(), run.log.paths[n].end(), [&frame](SpanId id) {
          return frame.spans[static_cast<std::size_t>(id)].phase == Phase::solve;
        });
    EXPECT_EQ(solves, 1) << "the path goes through the board";
  }
  EXPECT_EQ(run.platform.board()->illegal_accesses(), 0);
}

TEST(TransferFrame, BurstsAreWhatTheyWere) {
  SmallScene scene;
  expect_frames(scene, transfer(Method::bursts, Notification::intx), test::latency(scene));
}

TEST(TransferFrame, ProgrammedIoIsAnAccessAWord) {
  SmallScene scene;
  expect_frames(scene, transfer(Method::programmed_io, Notification::intx),
                rest(scene) + kWords * pci_write(4) + pci_write(4) + solve_time(scene) +
                    kInterrupt + acknowledged() + kWords * pci_read(4));
}

TEST(TransferFrame, WordsThatAreNotPackedAreTwiceAsMany) {
  SmallScene scene;
  Transfer t = transfer(Method::programmed_io, Notification::intx);
  t.packed = false;
  expect_frames(scene, t,
                rest(scene) + 2 * kWords * pci_write(4) + pci_write(4) + solve_time(scene) +
                    kInterrupt + acknowledged() + 2 * kWords * pci_read(4));
}

TEST(TransferFrame, CombinedWritesAreBurstsAndReadsAreNot) {
  SmallScene scene;
  expect_frames(scene, transfer(Method::write_combined_io, Notification::intx),
                rest(scene) + pci_write(kBytes) + pci_write(4) + solve_time(scene) + kInterrupt +
                    acknowledged() + kWords * pci_read(4));
}

TEST(TransferFrame, MessageIsAWriteOfTheBoard) {
  SmallScene scene;
  expect_frames(scene, transfer(Method::bursts, Notification::msi),
                test::latency(scene) + board_write(4));
}

TEST(TransferFrame, DmaWithMessages) {
  SmallScene scene;
  expect_frames(scene, transfer(Method::dma, Notification::msi),
                rest(scene) + pci_write(4) + list_time(scene) + board_write(4) + kInterrupt);
}

TEST(TransferFrame, DmaWithALine) {
  SmallScene scene;
  expect_frames(scene, transfer(Method::dma, Notification::intx),
                rest(scene) + pci_write(4) + list_time(scene) + kInterrupt + acknowledged());
}

TEST(TransferFrame, DmaWithLooksAtMemory) {
  SmallScene scene;
  Transfer t = transfer(Method::dma, Notification::polling);
  t.poll_interval_s = 700e-9;
  const Picoseconds interval = 700 * kNs;
  const Picoseconds looks = (list_time(scene) + interval - 1) / interval;
  expect_frames(scene, t, rest(scene) + pci_write(4) + looks * interval);
}

TEST(TransferFrame, LooksAtStatus) {
  SmallScene scene;
  const Transfer t = transfer(Method::bursts, Notification::polling);
  const Picoseconds period = pci_read(4) + kUs;
  Picoseconds seen = pci_read(4);
  while (seen < solve_time(scene)) seen += period;
  expect_frames(
      scene, t,
      rest(scene) + pci_write(kBytes) + pci_write(4) + seen + pci_write(4) + pci_read(kBytes));
}

TEST(TransferFrame, DescriptorsOfSmallSegments) {
  SmallScene scene;
  Transfer t = transfer(Method::dma, Notification::msi);
  t.dma.emplace();
  t.dma->segment_bytes = 100;  // 100, 100 and 88 bytes each way
  const auto segments = [](auto move) { return 2 * move(100) + move(88); };
  expect_frames(scene, t,
                rest(scene) + pci_write(4) + 2 * kEngine + board_read(6 * 32) +
                    segments(board_read) + solve_time(scene) + segments(board_write) +
                    board_write(32) + board_write(4) + kInterrupt);
}

// The architect's plan is the platform's time.
TEST(TransferFrame, IsThePlansTime) {
  const link::PciInterconnect bus(link::Pci{}, {});
  const link::Payload payload{SmallScene::kUnknowns, SmallScene::kUnknowns, 16, true};
  const auto plan = [&](link::Movement movement, Notification notification) {
    return link::frame_transfer(bus, {}, payload, {movement, notification, 0});
  };
  SmallScene scene;
  const Picoseconds list = pci_write(4) + list_time(scene) - solve_time(scene);
  EXPECT_EQ(plan(link::Movement::dma, Notification::msi).total().latency_ps, list + board_write(4));
  EXPECT_EQ(plan(link::Movement::dma, Notification::intx).total().latency_ps,
            list + acknowledged());
  // Without posted writes every store takes its way: only U is the plan's.
  EXPECT_EQ(plan(link::Movement::programmed_io, Notification::intx).to_host_total().latency_ps,
            acknowledged() + kWords * pci_read(4));
}

// Numbers of a run in a process of its own; none where it did not come to its end.
std::vector<std::int64_t> in_child_process(const std::function<std::vector<std::int64_t>()>& work) {
  const std::string bytes = test::output_of_child([&work](std::string& to) {
    const std::vector<std::int64_t> numbers = work();
    to.assign(reinterpret_cast<const char*>(numbers.data()), 8 * numbers.size());
  });
  std::vector<std::int64_t> numbers(bytes.size() / 8);
  std::memcpy(numbers.data(), bytes.data(), 8 * numbers.size());
  return numbers;
}

// Forces of all frames, bit by bit, of a run in a process of its own.
std::vector<std::int64_t> forces(const Transfer& t, const SmallScene::Options& options, int depth) {
  return in_child_process([&] {
    SmallScene scene(options);
    scene.touch();
    scene.settings.transfer = t;
    scene.settings.frames = 60;
    scene.settings.host.pipeline_depth = depth;
    scene.settings.budget = (1 + depth) * scene.settings.period;
    const Simulated run(scene);
    std::vector<std::int64_t> bits;
    for (const Frame& frame : run.log.frames) {
      bits.push_back(frame.solved() ? 1 : 0);
      for (int i = 0; i < 3; ++i)
        bits.push_back(std::bit_cast<std::int64_t>(frame.touch().force[i]));
    }
    return bits;
  });
}

// Posted, a line overtakes U and the record by 50 us: a driver that believed in memory before it
// has read STATUS would take those of the frame before.
TEST(TransferWords, AreTheSameWhereALineOvertakesThem) {
  const std::vector<std::int64_t> expected = forces({}, {}, 0);
  const auto posted = [](Notification notification) {
    return in_child_process([notification] {
      SmallScene scene;
      scene.touch();
      scene.settings.transfer = transfer(Method::dma, notification);
      scene.settings.bus.posted_writes.emplace();
      scene.settings.bus.posted_writes->to_memory_s = 50e-6;
      scene.settings.frames = 60;
      const Simulated run(scene);
      std::vector<std::int64_t> bits;
      for (const Frame& frame : run.log.frames) {
        bits.push_back(frame.solved() ? 1 : 0);
        for (int i = 0; i < 3; ++i)
          bits.push_back(std::bit_cast<std::int64_t>(frame.touch().force[i]));
      }
      return bits;
    });
  };
  ASSERT_EQ(expected.size(), 4U * 60U);
  EXPECT_EQ(posted(Notification::intx), expected);
  EXPECT_EQ(posted(Notification::msi), expected);
  EXPECT_EQ(posted(Notification::polling), expected);
}

void expect_the_same_words(const SmallScene::Options& options, int depth) {
  const std::vector<std::int64_t> expected = forces({}, options, depth);
  ASSERT_EQ(expected.size(), 4U * 60U);
  EXPECT_NE(expected[4 * 59 + 3], 0);  // it touches
  for (const Method method :
       {Method::bursts, Method::programmed_io, Method::write_combined_io, Method::dma}) {
    for (const Notification notification :
         {Notification::intx, Notification::msi, Notification::polling}) {
      for (const bool packed : {true, false}) {
        Transfer t = transfer(method, notification);
        t.packed = packed;
        EXPECT_EQ(forces(t, options, depth), expected)
            << name(method) << ", " << link::name(notification) << ", " << packed;
      }
    }
  }
}

TEST(TransferWords, AreTheSameByEveryWay) { expect_the_same_words({}, 0); }

TEST(TransferWords, AreTheSameWhereFramesOverlap) { expect_the_same_words({}, 1); }

TEST(TransferWords, AreTheSameWithSeveralJobsAFrame) {
  SmallScene::Options options;
  options.solver.method = fixed::Method::jacobi_pcg;
  options.solver.vector_bits = 24;
  options.refinement.emplace();
  expect_the_same_words(options, 0);
}

// A job that comes too late is given up while the engine is at work; the run goes on.
void expect_held_forces(Notification notification) {
  SmallScene scene;
  scene.settings.transfer = transfer(Method::dma, notification);
  scene.settings.host.timeout_s = 20e-6;
  ASSERT_GT(solve_time(scene), 20 * kUs);
  const Simulated run(scene);
  ASSERT_EQ(run.log.frames.size(), 10U);
  for (const Frame& frame : run.log.frames) EXPECT_FALSE(frame.solved());
  EXPECT_EQ(run.platform.servo().counts().last_error, HVP_ERROR_TIMEOUT);
  EXPECT_EQ(run.platform.servo().counts().driver_errors, 10);
}

TEST(TransferTimeOut, OfAMessage) { expect_held_forces(Notification::msi); }
TEST(TransferTimeOut, OfALine) { expect_held_forces(Notification::intx); }
TEST(TransferTimeOut, OfLooks) { expect_held_forces(Notification::polling); }

// While the record is on the bus and while the message is: the frame waits for neither in vain.
TEST(TransferTimeOut, WhileTheEndIsOnItsWay) {
  for (Picoseconds before = 0; before < 3 * kUs; before += 100 * kNs) {
    EXPECT_EQ(in_child_process([before] {
                SmallScene scene;
                scene.settings.transfer = transfer(Method::dma, Notification::msi);
                scene.settings.host.timeout_s =
                    static_cast<double>(list_time(scene) + kUs - before) * 1e-12;
                const Simulated run(scene);
                return std::vector<std::int64_t>{static_cast<std::int64_t>(run.log.frames.size())};
              }),
              std::vector<std::int64_t>{10});
  }
}

TEST(TransferComposition, OnlyAMasterHasAnEngineAndAMemory) {
  SmallScene scene;
  scene.settings.transfer = transfer(Method::dma, Notification::intx);
  const Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  EXPECT_EQ(Platform::modules(),
            (std::vector<std::string>{"bus", "accelerator", "accelerator.dma", "memory", "daq",
                                      "access", "servo", "collision"}));
  EXPECT_EQ(Platform::processes(), 4U);
}

TEST(TransferComposition, ProgrammedIoBuildsNothing) {
  SmallScene scene;
  scene.settings.transfer = transfer(Method::programmed_io, Notification::polling);
  const Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  EXPECT_EQ(Platform::modules().size(), 6U);
  EXPECT_EQ(Platform::processes(), 3U);
}

TEST(TransferSettings, SegmentsAreWholeWords) {
  EXPECT_TRUE(Transfer{}.plain());
  link::DmaEngine engine;
  EXPECT_NO_THROW(engine.check());
  engine.segment_bytes = 66;
  EXPECT_THROW(engine.check(), InputError);
}

TEST(TransferSettings, TooManySegmentsAreRefused) {
  HostMemory memory("memory", 1 << 20);
  link::DmaEngine engine;
  engine.segment_bytes = 64;
  EXPECT_NO_THROW(DmaMemory(memory, engine, {128 * 64, 128 * 64}));
  EXPECT_THROW(DmaMemory(memory, engine, {128 * 64, 128 * 64 + 4}), InputError);
}

}  // namespace
}  // namespace hvp::vp::transfer_test
