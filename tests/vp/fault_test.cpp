// Faults of the board and its bus: what the driver returns, how long it takes, which force is held,
// and that the loop goes on with the right words afterwards.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/vp/child_output.h"
#include "tests/vp/expected_frame.h"
#include "vp/platform.h"

namespace hvp::vp::fault_test {
namespace {

using test::FrameLog;
using test::kMs;
using test::kNs;
using test::kUs;
using test::Simulated;
using test::SmallScene;

constexpr std::int64_t kAt = 25;
constexpr std::int64_t kFrames = 40;
constexpr int kVectorBytes = 2 * SmallScene::kUnknowns;
// The bridge's status register: the processor's and the bridge's part of an access.
constexpr Picoseconds kReadErrors = 700 * kNs;
constexpr Picoseconds kClearErrors = 100 * kNs;

Fault at(FaultKind kind, std::int64_t frame, FaultAccess access = FaultAccess::first) {
  Fault fault;
  fault.kind = kind;
  fault.frame = frame;
  fault.access = access;
  return fault;
}

Fault gone_for(std::int64_t frame, std::int64_t frames) {
  Fault fault = at(FaultKind::device_gone, frame);
  fault.frames = frames;
  return fault;
}

Fault flipped(std::int64_t frame, FaultAccess access, int bits) {
  Fault fault = at(FaultKind::corrupted_word, frame, access);
  fault.bits = bits;
  return fault;
}

// A body that is touched and at rest. From zero each job is for itself, so that a frame that is
// left out changes nothing in the next one.
void prepare(SmallScene& scene, const std::vector<Fault>& faults, int pipeline_depth = 0,
             fixed::Start start = fixed::Start::zero) {
  scene.touch();
  scene.settings.frames = kFrames;
  scene.settings.host.timeout_s = 1e-3;
  scene.settings.solver.start = start;
  scene.settings.host.pipeline_depth = pipeline_depth;
  scene.settings.budget = (1 + pipeline_depth) * scene.settings.period;
  scene.settings.faults = faults;
}

std::vector<std::int64_t> force_bits(const FrameLog& log) {
  std::vector<std::int64_t> bits;
  for (const Frame& frame : log.frames) {
    for (int i = 0; i < 3; ++i) bits.push_back(std::bit_cast<std::int64_t>(frame.touch().force[i]));
  }
  return bits;
}

// The numbers that `work` returns, made in a child process; none where it failed.
template <class Work>
std::vector<std::int64_t> numbers_of_child(const Work& work) {
  const std::string text = test::output_of_child([&work](std::string& out) {
    for (const std::int64_t number : work()) {
      out.append(reinterpret_cast<const char*>(&number), sizeof(number));
    }
  });
  std::vector<std::int64_t> numbers(text.size() / sizeof(std::int64_t));
  std::memcpy(numbers.data(), text.data(), numbers.size() * sizeof(std::int64_t));
  return numbers;
}

// Of a run without a fault.
std::vector<std::int64_t> undisturbed(int pipeline_depth = 0,
                                      fixed::Start start = fixed::Start::zero) {
  return numbers_of_child([pipeline_depth, start] {
    SmallScene scene;
    prepare(scene, {}, pipeline_depth, start);
    const Simulated run(scene);
    return force_bits(run.log);
  });
}

std::int64_t count(const Simulated& run, hvp_status status) {
  return run.platform.servo().counts().errors[static_cast<std::size_t>(status)].count;
}

// What must hold for any run: frames in their order, each solved or held, causes without a gap.
void expect_nothing_lost(const Simulated& run) {
  const ServoCounts& counts = run.platform.servo().counts();
  std::int64_t solved = 0;
  std::int64_t last = -1;
  for (std::size_t n = 0; n < run.log.frames.size(); ++n) {
    const Frame& frame = run.log.frames[n];
    EXPECT_GT(frame.number, last);
    last = frame.number;
    if (frame.solved()) ++solved;
    EXPECT_EQ(frame.solved(), frame.status == HVP_OK);
    EXPECT_EQ(std::accumulate(run.log.paths[n].begin(), run.log.paths[n].end(), Picoseconds{0},
                              [&](Picoseconds sum, SpanId id) {
                                const Span& span = frame.spans[static_cast<std::size_t>(id)];
                                return sum + span.end - span.start;
                              }),
              frame.latency());
  }
  const Verdict& verdict = run.platform.verdict();
  EXPECT_EQ(verdict.frames(), solved + counts.held_frames);
  EXPECT_EQ(verdict.unsolved(), counts.held_frames);
  EXPECT_EQ(verdict.frames() + verdict.skipped_ticks(), run.scene.settings.frames);
  if (const FaultPlan* faults = run.platform.faults()) {
    for (const FaultRecord& r : faults->records()) EXPECT_GE(r.unnoticed(), 0);
  }
}

// Frames from `first` on have the forces of a run without a fault; those in [held, first) have that
// of the frame before.
void expect_forces(const Simulated& run, const std::vector<std::int64_t>& clean, std::int64_t held,
                   std::int64_t first) {
  ASSERT_EQ(clean.size(), static_cast<std::size_t>(3 * kFrames));
  const std::vector<std::int64_t> bits = force_bits(run.log);
  ASSERT_EQ(bits.size(), clean.size());
  for (std::int64_t n = 0; n < kFrames; ++n) {
    const bool is_held = n >= held && n < first;
    EXPECT_EQ(run.log.frames[static_cast<std::size_t>(n)].solved(), !is_held) << "frame " << n;
    const std::int64_t same = is_held ? held - 1 : n;
    for (std::int64_t i = 0; i < 3; ++i) {
      EXPECT_EQ(bits[static_cast<std::size_t>(3 * n + i)],
                clean[static_cast<std::size_t>(3 * same + i)])
          << "frame " << n;
    }
  }
}

// ---- What each fault costs, to the picosecond.

struct Times : testing::Test {
  // Of an undisturbed frame that asks for the bus' errors, and of the faulty one.
  static Picoseconds usual(const Simulated& run) {
    return run.log.frames[static_cast<std::size_t>(kAt - 1)].latency();
  }
  static Picoseconds faulty(const Simulated& run) {
    return run.log.frames[static_cast<std::size_t>(kAt)].latency();
  }
  static Picoseconds solve(const SmallScene& scene) {
    return test::solve_time(scene.computation.board().matrix().row_begin, 60);
  }
};

TEST_F(Times, AskingForErrorsIsOneReadMoreThatNothingHides) {
  SmallScene scene;
  scene.settings.host.recovery.bus_errors = host::Guard::always;
  const Simulated run(scene);
  // The other one, after the start, is beside the solve.
  EXPECT_EQ(run.log.frames[5].latency(), test::latency(scene) + kReadErrors);
  EXPECT_TRUE(run.platform.verdict().force_in_time());
}

TEST_F(Times, LostInterruptCostsTheTimeOut) {
  const std::vector<std::int64_t> clean = undisturbed();
  SmallScene scene;
  prepare(scene, {at(FaultKind::lost_interrupt, kAt)});
  const Simulated run(scene);
  // The driver waits from the look at the bus' errors on, and then needs no interrupt.
  EXPECT_EQ(faulty(run) - usual(run), kReadErrors + 1 * kMs - solve(scene) - 5 * kUs);
  EXPECT_EQ(run.platform.servo().counts().mended.lost_interrupts, 1);
  EXPECT_EQ(run.platform.faults()->unnoticed(), 0);
  EXPECT_TRUE(run.platform.verdict().force_in_time());
  expect_forces(run, clean, kFrames, kFrames);
  expect_nothing_lost(run);
}

TEST_F(Times, StuckBoardCostsTheTimeOutAndASetUp) {
  SmallScene scene;
  prepare(scene, {at(FaultKind::stuck_busy, kAt)});
  scene.hover();
  const Simulated run(scene);
  const Frame& frame = run.log.frames[static_cast<std::size_t>(kAt)];
  EXPECT_EQ(usual(run), test::latency(scene) + kReadErrors);
  // After the time-out: a look at STATUS; no acknowledgement, no U, no force to compute.
  const Picoseconds not_done = solve(scene) + 5 * kUs + test::pci_write(4) + 1 * kUs +
                               test::pci_read(kVectorBytes) + kReadErrors +
                               test::compute(4.0 * SmallScene::kUnknowns);
  EXPECT_EQ(faulty(run) - usual(run), kReadErrors + 1 * kMs - not_done);
  // The board is brought back as it was set up, while the output settles.
  EXPECT_EQ(frame.work_done - frame.born - faulty(run) + 10 * kUs,
            run.platform.servo().set_up_time());
  EXPECT_EQ(count(run, HVP_ERROR_TIMEOUT), 1);
  EXPECT_EQ(run.platform.servo().counts().recoveries, 1);
  EXPECT_EQ(run.platform.servo().counts().longest_hold, 1);
  expect_nothing_lost(run);
}

TEST_F(Times, DamagedSolutionIsReadAgain) {
  const std::vector<std::int64_t> clean = undisturbed();
  SmallScene scene;
  prepare(scene, {flipped(kAt, FaultAccess::solution, 1)});
  const Simulated run(scene);
  EXPECT_EQ(faulty(run) - usual(run), kClearErrors + test::pci_read(kVectorBytes) + kReadErrors);
  EXPECT_EQ(run.platform.servo().counts().mended.damaged, 1);
  EXPECT_EQ(count(run, HVP_ERROR_DATA), 1);
  EXPECT_EQ(run.platform.faults()->unnoticed(), 0);
  expect_forces(run, clean, kFrames, kFrames);
  expect_nothing_lost(run);
}

TEST_F(Times, SolutionThatNobodySentIsReadAgain) {
  const std::vector<std::int64_t> clean = undisturbed();
  SmallScene scene;
  prepare(scene, {at(FaultKind::master_abort, kAt, FaultAccess::solution)});
  const Simulated run(scene);
  EXPECT_EQ(faulty(run) - usual(run), kClearErrors + test::pci_read(kVectorBytes) + kReadErrors);
  EXPECT_EQ(run.platform.servo().counts().mended.aborted, 1);
  expect_forces(run, clean, kFrames, kFrames);
  expect_nothing_lost(run);
}

TEST_F(Times, StatusThatNobodySentIsReadAgain) {
  const std::vector<std::int64_t> clean = undisturbed();
  SmallScene scene;
  prepare(scene, {at(FaultKind::master_abort, kAt, FaultAccess::status)});
  const Simulated run(scene);
  // The line is still up: another interrupt latency, another look, and later the bridge's record of
  // it, which spoils the first U.
  EXPECT_EQ(faulty(run) - usual(run), 5 * kUs + test::pci_read(4) + kClearErrors +
                                          test::pci_read(kVectorBytes) + kReadErrors);
  expect_forces(run, clean, kFrames, kFrames);
  expect_nothing_lost(run);
}

TEST_F(Times, LostStartIsKnownAtOnce) {
  const std::vector<std::int64_t> clean = undisturbed();
  SmallScene scene;
  prepare(scene, {at(FaultKind::master_abort, kAt, FaultAccess::start)});
  const Simulated run(scene);
  EXPECT_LT(faulty(run), usual(run) - solve(scene));
  EXPECT_EQ(run.log.frames[static_cast<std::size_t>(kAt)].status, HVP_ERROR_BUS);
  expect_forces(run, clean, kAt, kAt + 1);
  expect_nothing_lost(run);
}

// ---- Every kind, one frame after the other and pipelined.

struct Case {
  const char* what;
  Fault fault;
  hvp_status status;  // of the frame
  std::int64_t held;  // frames
  bool noticed = true;
};

struct EveryFault : testing::TestWithParam<std::tuple<Case, int>> {};

TEST_P(EveryFault, EndsInItsStatusAndTheRightWordsComeBack) {
  const auto& [c, depth] = GetParam();
  const std::vector<std::int64_t> clean = undisturbed(depth);
  SmallScene scene;
  prepare(scene, {c.fault}, depth);
  const Simulated run(scene);
  const FaultPlan& faults = *run.platform.faults();
  EXPECT_EQ(faults.injected(), 1);
  EXPECT_EQ(faults.unnoticed(), c.noticed ? 0 : 1);
  EXPECT_EQ(run.log.frames[static_cast<std::size_t>(kAt)].status, c.status);
  EXPECT_EQ(run.platform.servo().counts().held_frames, c.held);
  EXPECT_EQ(run.platform.verdict().skipped_ticks(), 0);
  if (c.noticed) expect_forces(run, clean, kAt, kAt + c.held);
  expect_nothing_lost(run);
}

INSTANTIATE_TEST_SUITE_P(
    Faults, EveryFault,
    testing::Combine(
        testing::Values(
            Case{"lost_interrupt", at(FaultKind::lost_interrupt, kAt), HVP_OK, 0},
            Case{"stuck_busy", at(FaultKind::stuck_busy, kAt), HVP_ERROR_TIMEOUT, 1},
            Case{"saturated_solve", at(FaultKind::saturated_solve, kAt), HVP_ERROR_SATURATED, 1},
            Case{"lost_rhs", at(FaultKind::master_abort, kAt, FaultAccess::rhs), HVP_ERROR_BUS, 1},
            Case{"lost_start", at(FaultKind::master_abort, kAt, FaultAccess::start), HVP_ERROR_BUS,
                 1},
            Case{"lost_status", at(FaultKind::master_abort, kAt, FaultAccess::status), HVP_OK, 0},
            Case{"lost_acknowledge", at(FaultKind::master_abort, kAt, FaultAccess::acknowledge),
                 HVP_OK, 0},
            Case{"reset_by_somebody_else", at(FaultKind::function_level_reset, kAt),
                 HVP_ERROR_TIMEOUT, 1},
            Case{"lost_solution", at(FaultKind::master_abort, kAt, FaultAccess::solution), HVP_OK,
                 0},
            Case{"damaged_rhs", flipped(kAt, FaultAccess::rhs, 3), HVP_ERROR_DATA, 1},
            Case{"damaged_solution", flipped(kAt, FaultAccess::solution, 1), HVP_OK, 0},
            // Parity is even over 32 bits: two of them pass it.
            Case{"undetected_solution", flipped(kAt, FaultAccess::solution, 2), HVP_OK, 0, false}),
        testing::Values(0, 1)),
    [](const auto& p) {
      return std::string(std::get<0>(p.param).what) +
             (std::get<1>(p.param) == 0 ? "" : "_pipelined");
    });

// A job that was not used is not started from: what follows is what would have come a frame
// earlier.
struct WarmStart : testing::TestWithParam<FaultKind> {};

TEST_P(WarmStart, GoesOnFromTheLastSolutionThatWasUsed) {
  // A hand-over goes on by the time, whether a frame is held or not.
  SmallScene::Options at_once;
  at_once.hand_over_s = 0;
  // Few: the frames go on converging long after the contact was met.
  at_once.solver.iterations = 2;
  const std::vector<std::int64_t> clean = numbers_of_child([&] {
    SmallScene scene(at_once);
    prepare(scene, {}, 0, fixed::Start::warm);
    const Simulated run(scene);
    return force_bits(run.log);
  });
  SmallScene scene(at_once);
  prepare(scene, {at(GetParam(), kAt)}, 0, fixed::Start::warm);
  const Simulated run(scene);
  EXPECT_EQ(run.platform.servo().counts().held_frames, 1);
  const std::vector<std::int64_t> bits = force_bits(run.log);
  ASSERT_EQ(bits.size(), clean.size());
  // The words still change from frame to frame, or nothing would be shown.
  EXPECT_FALSE(std::equal(clean.begin() + 3 * kAt, clean.end() - 3, clean.begin() + 3 * (kAt + 1)));
  EXPECT_TRUE(std::equal(bits.begin() + 3 * (kAt + 1), bits.end(), clean.begin() + 3 * kAt));
}

INSTANTIATE_TEST_SUITE_P(Faults, WarmStart,
                         testing::Values(FaultKind::stuck_busy, FaultKind::saturated_solve));

struct EveryRate : testing::TestWithParam<std::tuple<int, int>> {};

// A fifth of the frames: whatever comes of it, the run ends and every frame is accounted for.
TEST_P(EveryRate, LosesNothing) {
  const auto& [kind, depth] = GetParam();
  Fault fault;
  fault.kind = static_cast<FaultKind>(kind);
  fault.rate = 0.2;
  if (fault.kind == FaultKind::device_gone) fault.frames = 1;
  const bool aer =
      fault.kind == FaultKind::aer_correctable || fault.kind == FaultKind::aer_uncorrectable;
  if (fault.kind == FaultKind::late_dma) fault.delay_s = 2e-3;
  if (fault.kind == FaultKind::truncated_dma) fault.bytes = 8;
  SmallScene scene;
  prepare(scene, {fault}, depth);
  if (fault.kind == FaultKind::late_dma || fault.kind == FaultKind::truncated_dma) {
    scene.settings.transfer.method = Transfer::Method::dma;
  }
  if (aer) scene.settings.bus.pcie.emplace();
  const bool flips = fault.kind == FaultKind::flip;
  if (flips) scene.settings.fidelity.accelerator = Timing::cycle_accurate;
  scene.settings.frames = 100;
  const Simulated run(scene);
  const FaultPlan& faults = *run.platform.faults();
  if (fault.kind == FaultKind::surprise_removal) {
    EXPECT_EQ(faults.injected(), 1);  // and the board is gone
  } else {
    EXPECT_GT(faults.injected(), 5);
  }
  if (!flips) {
    EXPECT_EQ(faults.unnoticed(), 0);
  }
  expect_nothing_lost(run);
}

INSTANTIATE_TEST_SUITE_P(Faults, EveryRate,
                         testing::Combine(testing::Range(0, kFaultKinds), testing::Values(0, 1)),
                         [](const auto& p) {
                           std::string text = name(static_cast<FaultKind>(std::get<0>(p.param)));
                           std::ranges::replace(text, '-', '_');
                           return text + (std::get<1>(p.param) == 0 ? "" : "_pipelined");
                         });

// ---- With the board as master.

void use_dma(SmallScene& scene, link::Notification notification) {
  scene.settings.transfer.method = Transfer::Method::dma;
  scene.settings.transfer.notification = notification;
}

std::vector<std::int64_t> undisturbed_dma(link::Notification notification) {
  return numbers_of_child([notification] {
    SmallScene scene;
    prepare(scene, {});
    use_dma(scene, notification);
    const Simulated run(scene);
    return force_bits(run.log);
  });
}

struct DmaCase {
  const char* what;
  Fault fault;
  hvp_status status;
  std::int64_t held;
};

Fault late(double delay_s) {
  Fault fault = at(FaultKind::late_dma, kAt);
  fault.delay_s = delay_s;
  return fault;
}

Fault truncated(int bytes) {
  Fault fault = at(FaultKind::truncated_dma, kAt);
  fault.bytes = bytes;
  return fault;
}

TEST(LostAcknowledgement, IsNoticedOfItsFrameWhenTheNextTicksHadNone) {
  SmallScene scene;
  prepare(scene, {at(FaultKind::master_abort, 0, FaultAccess::acknowledge)});
  // STATUS of the next job tells, and a frame takes several periods.
  scene.settings.host.recovery.bus_errors = host::Guard::never;
  scene.settings.host.sustained_rate_flops = 1e5;
  const Simulated run(scene);
  ASSERT_GT(run.log.frames.size(), 1U);
  EXPECT_GT(run.log.frames[1].number, 1);
  EXPECT_EQ(run.platform.servo().counts().mended.lost_acknowledgements, 1);
  EXPECT_EQ(run.platform.faults()->records()[0].noticed, 1);
}

TEST(LostAcknowledgement, OfTheFirstFrameIsNoticedOnceWithDma) {
  SmallScene scene;
  prepare(scene, {at(FaultKind::master_abort, 0, FaultAccess::acknowledge)});
  use_dma(scene, link::Notification::intx);
  const Simulated run(scene);
  EXPECT_EQ(run.platform.servo().counts().mended.lost_acknowledgements, 1);
  EXPECT_EQ(run.platform.faults()->records()[0].noticed, 1);
}

struct DmaFaults : testing::TestWithParam<std::tuple<DmaCase, link::Notification>> {};

TEST_P(DmaFaults, EndInTheirStatusAndTheRightWordsComeBack) {
  const auto& [c, notification] = GetParam();
  const std::vector<std::int64_t> clean = undisturbed_dma(notification);
  SmallScene scene;
  prepare(scene, {c.fault});
  use_dma(scene, notification);
  const Simulated run(scene);
  EXPECT_EQ(run.platform.faults()->injected(), 1);
  EXPECT_EQ(run.log.frames[kAt].status, c.status);
  EXPECT_EQ(run.platform.servo().counts().held_frames, c.held);
  expect_forces(run, clean, kAt, kAt + c.held);
  expect_nothing_lost(run);
  const Picoseconds more = run.log.frames[kAt].latency() - run.log.frames[kAt - 1].latency();
  if (c.fault.kind == FaultKind::late_dma && c.held == 0) {
    EXPECT_EQ(more, c.fault.delay_ps());
  }
  EXPECT_EQ(run.platform.faults()->unnoticed(), 0);
}

INSTANTIATE_TEST_SUITE_P(
    Faults, DmaFaults,
    testing::Combine(
        testing::Values(DmaCase{"lost_interrupt", at(FaultKind::lost_interrupt, kAt), HVP_OK, 0},
                        DmaCase{"stuck_busy", at(FaultKind::stuck_busy, kAt), HVP_ERROR_TIMEOUT, 1},
                        DmaCase{"reset_by_somebody_else", at(FaultKind::function_level_reset, kAt),
                                HVP_ERROR_TIMEOUT, 1},
                        DmaCase{"saturated", at(FaultKind::saturated_solve, kAt),
                                HVP_ERROR_SATURATED, 1},
                        DmaCase{"late", late(300e-6), HVP_OK, 0},
                        DmaCase{"too_late", late(1200e-6), HVP_ERROR_TIMEOUT, 1},
                        DmaCase{"truncated", truncated(64), HVP_ERROR_SHORT_TRANSFER, 1},
                        DmaCase{"cut_off", truncated(4096), HVP_ERROR_SHORT_TRANSFER, 1}),
        testing::Values(link::Notification::intx, link::Notification::msi)),
    [](const auto& p) {
      return std::string(std::get<0>(p.param).what) +
             (std::get<1>(p.param) == link::Notification::msi ? "_msi" : "_intx");
    });

// ---- On PCI Express.

TEST(PcieFaults, DamagedPacketIsSentAgain) {
  SmallScene scene;
  prepare(scene, {flipped(kAt, FaultAccess::solution, 2)});
  scene.settings.bus.pcie.emplace();
  const Simulated run(scene);
  const FaultRecord& record = run.platform.faults()->records()[0];
  EXPECT_EQ(record.corrected, 1);
  EXPECT_EQ(record.unnoticed(), 0);
  // Sent again in 0.33 us, which the completer's own latency hides; the words are right.
  EXPECT_EQ(run.log.frames[kAt].latency(), run.log.frames[kAt - 1].latency());
  EXPECT_EQ(run.log.frames[kAt].touch().force, run.log.frames[kAt - 1].touch().force);
  EXPECT_EQ(run.platform.servo().counts().held_frames, 0);
  expect_nothing_lost(run);
}

TEST(PcieFaults, LostStartIsFoundByTheTimeOut) {
  SmallScene scene;
  prepare(scene, {at(FaultKind::master_abort, kAt, FaultAccess::start)});
  scene.settings.bus.pcie.emplace();
  const Simulated run(scene);
  EXPECT_EQ(run.log.frames[kAt].status, HVP_ERROR_TIMEOUT);
  EXPECT_EQ(run.platform.servo().counts().held_frames, 1);
  EXPECT_EQ(run.platform.faults()->unnoticed(), 0);
  expect_nothing_lost(run);
}

TEST(PcieFaults, ACorrectableErrorCostsAReplay) {
  SmallScene scene;
  prepare(scene, {at(FaultKind::aer_correctable, kAt, FaultAccess::status)});
  scene.settings.bus.pcie.emplace();
  const link::Pcie link = *scene.settings.bus.pcie;
  const Simulated run(scene);
  EXPECT_EQ(run.platform.faults()->records()[0].corrected, 1);
  EXPECT_EQ(run.platform.faults()->unnoticed(), 0);
  // The completer's own latency hides what is shorter than that.
  const Picoseconds replay = 2 * link.link_ps() + link.transfer_ps(link.request_wire_bytes(4));
  const Picoseconds hidden = std::min(replay, link.completer_ps(link::PcieSide::root));
  EXPECT_EQ(run.log.frames[kAt].latency() - run.log.frames[kAt - 1].latency(), replay - hidden);
  EXPECT_EQ(run.platform.servo().counts().held_frames, 0);
  expect_nothing_lost(run);
}

struct Poisoned {
  FaultAccess access;
  hvp_status status;
};
struct PoisonedPacket : testing::TestWithParam<Poisoned> {};

// The driver asks for the bus' errors: what cannot be read again fails the frame.
TEST_P(PoisonedPacket, IsNoticedByItsFrame) {
  const std::vector<std::int64_t> clean = numbers_of_child([] {
    SmallScene scene;
    prepare(scene, {});
    scene.settings.bus.pcie.emplace();
    const Simulated run(scene);
    return force_bits(run.log);
  });
  SmallScene scene;
  prepare(scene, {at(FaultKind::aer_uncorrectable, kAt, GetParam().access)});
  scene.settings.bus.pcie.emplace();
  const Simulated run(scene);
  const std::int64_t held = GetParam().status == HVP_OK ? 0 : 1;
  EXPECT_EQ(hvp_status_name(run.log.frames[kAt].status),
            std::string(hvp_status_name(GetParam().status)));
  EXPECT_EQ(run.platform.servo().counts().held_frames, held);
  EXPECT_EQ(run.platform.faults()->injected(), 1);
  EXPECT_EQ(run.platform.faults()->unnoticed(), 0);
  expect_forces(run, clean, kAt, kAt + held);
  expect_nothing_lost(run);
}

INSTANTIATE_TEST_SUITE_P(PcieFaults, PoisonedPacket,
                         testing::Values(Poisoned{FaultAccess::rhs, HVP_ERROR_DATA},
                                         Poisoned{FaultAccess::start, HVP_ERROR_DATA},
                                         Poisoned{FaultAccess::acknowledge, HVP_OK}),
                         [](const auto& p) { return std::string(name(p.param.access)); });

TEST(PcieFaults, BoardThatIsGoneComesBack) {
  SmallScene scene;
  prepare(scene, {gone_for(kAt, 3)});
  scene.settings.bus.pcie.emplace();
  const Simulated run(scene);
  EXPECT_EQ(run.log.frames[kAt].status, HVP_ERROR_BUS);
  EXPECT_EQ(run.platform.servo().counts().recoveries, 1);
  EXPECT_EQ(run.platform.faults()->unnoticed(), 0);
  EXPECT_TRUE(run.log.frames.back().solved());
  expect_nothing_lost(run);
}

// ---- A board that goes away.

// Set-ups in frames 25, 26, 28 and 32: the board is back from tick 30 on.
TEST(DeviceGone, ComesBackAndIsSetUpAgain) {
  const std::vector<std::int64_t> clean = undisturbed();
  SmallScene scene;
  prepare(scene, {gone_for(kAt, 5)});
  const Simulated run(scene);
  const ServoCounts& counts = run.platform.servo().counts();
  EXPECT_EQ(counts.failed_set_ups, 3);
  EXPECT_EQ(counts.recoveries, 1);
  EXPECT_EQ(counts.held_frames, 8);
  EXPECT_EQ(counts.longest_hold, 8);
  EXPECT_EQ(counts.driver_errors, 1);
  EXPECT_EQ(count(run, HVP_ERROR_NO_DEVICE), 3);
  EXPECT_EQ(counts.errors[HVP_ERROR_BUS].first_frame, kAt);
  expect_forces(run, clean, kAt, kAt + 8);
  expect_nothing_lost(run);
}

// The board had the answer of frame 24 when it went.
TEST(DeviceGone, TakesTheFrameInFlightWithIt) {
  const std::vector<std::int64_t> clean = undisturbed(1);
  SmallScene scene;
  prepare(scene, {gone_for(kAt, 1)}, 1);
  const Simulated run(scene);
  EXPECT_EQ(run.platform.servo().counts().failed_set_ups, 1);
  EXPECT_EQ(run.platform.faults()->unnoticed(), 0);
  expect_forces(run, clean, kAt - 1, kAt + 1);
  expect_nothing_lost(run);
}

// It waits for its job until after the last tick: those in between have no force either.
TEST(SeveralFaults, TicksThatTheLastFrameTakesWithItAreHeld) {
  SmallScene scene;
  prepare(scene, {at(FaultKind::stuck_busy, kAt)});
  scene.settings.frames = kAt + 4;
  scene.settings.host.timeout_s = 10 * 1e-12 * static_cast<double>(scene.settings.period);
  const Simulated run(scene);
  EXPECT_EQ(run.log.frames.back().number, kAt);
  EXPECT_EQ(run.platform.verdict().skipped_ticks(), 3);
  EXPECT_EQ(run.platform.servo().counts().held_frames, 1);
  EXPECT_EQ(run.platform.servo().counts().longest_hold, 4);
}

// By one access: the words before it have been used, those behind it never come.
TEST(SurpriseRemoval, IsForGoodFromItsAccessOn) {
  SmallScene scene;
  prepare(scene, {at(FaultKind::surprise_removal, kAt, FaultAccess::status)});
  scene.settings.frames = 300;
  const Simulated run(scene);
  const ServoCounts& counts = run.platform.servo().counts();
  EXPECT_TRUE(run.log.frames[kAt - 1].solved());
  EXPECT_EQ(run.log.frames[kAt].status, HVP_ERROR_BUS);
  EXPECT_EQ(counts.failed_set_ups, 8);
  EXPECT_EQ(counts.recoveries, 0);
  EXPECT_EQ(counts.given_up_at, kAt + 127);
  EXPECT_EQ(run.platform.faults()->injected(), 1);
  EXPECT_EQ(run.platform.faults()->unnoticed(), 0);
  EXPECT_TRUE(run.platform.faults()->removed());
  expect_nothing_lost(run);
}

// Eight set-ups: frame 25 and 1, 3, 7, 15, 31, 63, 127 frames later.
TEST(DeviceGone, ForGoodIsGivenUp) {
  SmallScene scene;
  prepare(scene, {gone_for(kAt, 0)});
  scene.settings.frames = 300;
  const Simulated run(scene);
  const ServoCounts& counts = run.platform.servo().counts();
  EXPECT_EQ(counts.failed_set_ups, 8);
  EXPECT_EQ(counts.given_up_at, kAt + 127);
  EXPECT_EQ(counts.recoveries, 0);
  EXPECT_EQ(counts.held_frames, 300 - kAt);
  EXPECT_EQ(counts.longest_hold, 300 - kAt);
  EXPECT_EQ(run.platform.verdict().skipped_ticks(), 0);
  // A frame without a board takes its position and puts its force out, and that is all.
  EXPECT_EQ(run.log.frames.back().latency(), test::pci_write(4) + 1 * kUs + test::pci_read(12) +
                                                 1 * kUs + test::pci_write(12) + 10 * kUs);
  EXPECT_EQ(run.log.frames.back().touch().force, run.log.frames[kAt - 1].touch().force);
  expect_nothing_lost(run);
}

TEST(DeviceGone, WithoutALookAtTheBusTheTimeOutFindsIt) {
  SmallScene scene;
  prepare(scene, {gone_for(kAt, 2)});
  scene.settings.host.recovery.bus_errors = host::Guard::never;
  const Simulated run(scene);
  EXPECT_EQ(run.log.frames[kAt].status, HVP_ERROR_BUS);
  EXPECT_GT(run.log.frames[kAt].latency(), 1 * kMs);
  expect_nothing_lost(run);
}

// At 0, 2 and 6 ms.
TEST(DeviceGone, DuringSetUpIsWaitedFor) {
  SmallScene scene;
  prepare(scene, {gone_for(0, 3)});
  const Simulated run(scene);
  EXPECT_EQ(run.platform.servo().counts().failed_set_ups, 2);
  EXPECT_GT(run.platform.servo().set_up_time(), 6 * kMs);
  EXPECT_LT(run.platform.servo().set_up_time(), 8 * kMs);
  EXPECT_EQ(run.platform.servo().counts().held_frames, 0);
  EXPECT_EQ(run.platform.faults()->unnoticed(), 0);
  expect_nothing_lost(run);
}

TEST(DeviceGone, DuringSetUpForGoodEndsTheRun) {
  SmallScene scene;
  prepare(scene, {gone_for(0, 0)});
  Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  std::string what;
  try {
    platform.run();
  } catch (const std::runtime_error& e) {
    what = e.what();
  }
  EXPECT_EQ(what,
            std::string("the board could not be set up: ") + hvp_status_text(HVP_ERROR_NO_DEVICE));
}

// The board's reset is lost with it, so that the job that was given up ends when its frame has long
// been handed on.
TEST(DeviceGone, AJobThatNobodyWaitsForEndsQuietly) {
  SmallScene scene;
  prepare(scene, {gone_for(kAt, 4)}, 1);
  // A board that is slower than the loop: frame 24's job ends in a later period.
  scene.settings.accelerator.clock_hz = 5e6;
  scene.settings.host.timeout_s = 10e-3;
  const Simulated run(scene);
  EXPECT_GT(run.platform.servo().counts().held_frames, 0);
  EXPECT_EQ(run.platform.servo().counts().given_up_at, -1);
  expect_nothing_lost(run);
}

// ---- More than one.

TEST(SeveralFaults, InOneFrameAreAllNoticed) {
  const std::vector<std::int64_t> clean = undisturbed();
  SmallScene scene;
  prepare(scene, {at(FaultKind::lost_interrupt, kAt),
                  at(FaultKind::master_abort, kAt, FaultAccess::solution),
                  flipped(kAt, FaultAccess::rhs, 1), at(FaultKind::stuck_busy, kAt + 1)});
  const Simulated run(scene);
  // The damaged b is found before the board's interrupt could be missed.
  EXPECT_EQ(run.log.frames[kAt].status, HVP_ERROR_DATA);
  EXPECT_EQ(run.log.frames[kAt + 1].status, HVP_ERROR_TIMEOUT);
  EXPECT_EQ(run.platform.faults()->unnoticed(), 0);
  expect_forces(run, clean, kAt, kAt + 2);
  expect_nothing_lost(run);
}

// Whatever is mixed: the run ends, every frame is there, and the same seed gives the same run.
TEST(SeveralFaults, RandomMixesAlwaysEnd) {
  for (std::int64_t seed = 0; seed < 24; ++seed) {
    const auto mixed = [seed] {
      SmallScene scene;
      std::vector<Fault> faults;
      for (int i = 0; i < 5; ++i) {
        const random::Draws draws(seed, "mix");
        const auto u = draws.uniform(i);
        Fault fault;
        fault.kind = static_cast<FaultKind>(static_cast<int>(u.first * kFaultKinds));
        fault.delay_s = 1e-3 * static_cast<double>(seed % 4);
        fault.bytes = 4;
        fault.rate = 0.3 * u.second;
        if (fault.kind == FaultKind::device_gone) fault.frames = 1 + seed % 4;
        if (fault.kind == FaultKind::corrupted_word) fault.bits = 1 + static_cast<int>(seed % 3);
        faults.push_back(fault);
      }
      prepare(scene, faults, static_cast<int>(seed % 2));
      scene.settings.seed = seed;
      if (seed % 3 == 0) scene.settings.transfer.method = Transfer::Method::dma;
      if (seed % 6 == 0) scene.settings.transfer.notification = link::Notification::msi;
      scene.settings.frames = 120;
      scene.settings.host.recovery.bus_errors =
          seed % 5 == 0 ? host::Guard::never : host::Guard::with_faults;
      const Simulated run(scene);
      expect_nothing_lost(run);
      std::vector<std::int64_t> numbers = force_bits(run.log);
      for (const Frame& frame : run.log.frames) numbers.push_back(frame.work_done);
      if (testing::Test::HasFailure()) numbers.clear();
      return numbers;
    };
    const std::vector<std::int64_t> once = numbers_of_child(mixed);
    EXPECT_FALSE(once.empty()) << "seed " << seed;
    if (seed < 3) {
      EXPECT_EQ(once, numbers_of_child(mixed)) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace hvp::vp::fault_test
