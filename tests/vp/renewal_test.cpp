// Frames after which the board gets the matrix of the deformed body: the words that it has then,
// what the transfer takes to the picosecond, and what a fault in the middle of it leaves.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/vp/child_output.h"
#include "tests/vp/pressed_scene.h"

namespace hvp::vp::renewal_test {
namespace {

using test::around;
using test::blocks_of;
using test::due;
using test::expect_same_words;
using test::expect_transfer;
using test::find;
using test::kBoardClock;
using test::pci_write;
using test::PressedScene;
using Options = test::RenewalOptions;
using Simulated = test::SimulatedRenewal;

TEST(Renewal, TakesItsBlocksOverPci) {
  PressedScene scene({});
  const std::size_t entries = scene.computation.board().matrix().value.size();
  const Simulated run(scene);
  expect_transfer(scene, run, 5, around(kBoardClock) + blocks_of(entries, pci_write));
}

TEST(Renewal, TakesItsWordsByProgrammedIo) {
  PressedScene scene({});
  scene.settings.transfer.method = Transfer::Method::programmed_io;
  const std::size_t entries = scene.computation.board().matrix().value.size();
  const Simulated run(scene);
  expect_transfer(scene, run, 5, around(kBoardClock) + blocks_of(entries, [](int bytes) {
                                   return bytes / 4 * pci_write(4);
                                 }));
}

// 48 nodes of three divisions, 68 clocks each; the pipeline of 20.
TEST(Renewal, TakesTheDivisionsOfJacobisPreconditioner) {
  for (const Timing level :
       {Timing::loosely_timed, Timing::approximately_timed, Timing::cycle_accurate}) {
    const std::string outcome = test::output_of_child([level](std::string& out) {
      PressedScene scene({.method = fixed::Method::jacobi_pcg});
      scene.settings.fidelity.accelerator = level;
      const std::size_t entries = scene.computation.board().matrix().value.size();
      const Simulated run(scene);
      expect_transfer(scene, run, 5,
                      around((48 * 3 * 68 + 20) * kBoardClock) + blocks_of(entries, pci_write));
      out = testing::Test::HasFailure() ? "failed" : "passed";
    });
    EXPECT_EQ(outcome, "passed") << static_cast<int>(level);
  }
}

// The bits of every force of a run.
std::string forces(const Options& options, Timing level = Timing::loosely_timed) {
  return test::output_of_child([&](std::string& out) {
    PressedScene scene(options);
    scene.settings.fidelity.accelerator = level;
    const Simulated run(scene);
    for (const Frame& frame : run.log.frames) {
      for (int i = 0; i < 3; ++i) {
        out += std::to_string(std::bit_cast<std::int64_t>(frame.touch().force[i])) + " ";
      }
    }
  });
}

TEST(Renewal, GivesTheSameForcesAtEveryLevel) {
  const std::string closed_form = forces({});
  EXPECT_FALSE(closed_form.empty());
  EXPECT_EQ(forces({}, Timing::approximately_timed), closed_form);
  EXPECT_EQ(forces({}, Timing::cycle_accurate), closed_form);
  EXPECT_NE(forces({.renew_every = 0}), closed_form);
}

TEST(Renewal, IsNotThereWhereNothingIsRenewed) {
  PressedScene scene({.renew_every = 0});
  const Simulated run(scene);
  EXPECT_EQ(scene.computation.renewals(), nullptr);
  EXPECT_EQ(scene.computation.revision(), 0);
  for (const Frame& frame : run.log.frames) {
    for (const Span& span : frame.spans) {
      EXPECT_NE(span.phase, Phase::assemble);
      EXPECT_NE(span.phase, Phase::load_values);
    }
  }
}

// The tangents, then what the solver makes of them, all after the force. On a GPU the bytes that it
// solves with go there too. All renewals of a contact that stays take the same.
void expect_renewals(PressedScene& scene, Picoseconds to_gpu) {
  scene.settings.host.model = host::ProcessorModel::desktop_2026;
  const Simulated run(scene);
  const host::FrameMethod& method = scene.computation.method();
  const Picoseconds made =
      to_picoseconds(scene.settings.host.core_solve_s(method.renew_work(), method.memory().set_up));
  int renewed = 0;
  for (const Frame& frame : run.log.frames) {
    std::vector<Picoseconds> assembled;
    Picoseconds loaded = 0;
    // The body has moved on, which it does once the force is out.
    const Span* update = find(frame, Part::host, Phase::update);
    for (const Span& span : frame.spans) {
      if (span.phase == Phase::load_values) loaded += span.end - span.start;
      if (span.phase != Phase::assemble) continue;
      ASSERT_NE(update, nullptr) << frame.number;
      EXPECT_GE(span.start, update->end) << frame.number;
      assembled.push_back(span.end - span.start);
    }
    if (assembled.empty()) continue;
    ++renewed;
    ASSERT_EQ(assembled.size(), 2U) << frame.number;
    EXPECT_EQ(assembled[1], made) << frame.number;
    EXPECT_EQ(loaded, to_gpu) << frame.number;
  }
  EXPECT_GT(renewed, 3);
  EXPECT_EQ(scene.computation.renewals()->renewed, renewed);
}

TEST(Renewal, TakesTheHostsOwnFactors) {
  PressedScene scene({.solved_by = host::SolvedBy::cholesky});
  expect_renewals(scene, 0);
}

// Of 144 unknowns in double precision, by a driver's copy.
TEST(Renewal, TakesAGpusInverse) {
  PressedScene scene({.solved_by = host::SolvedBy::inverse});
  scene.settings.host.gpu.emplace();
  expect_renewals(scene, to_picoseconds(6.5e-6 + 144.0 * 144 * 8 / 15e9));
}

// A neo-Hookean body stiffens under the probe; words without room for it keep the last matrix.
TEST(Renewal, BeyondTheScaleIsFlaggedAndSendsNothing) {
  PressedScene scene({.headroom = 1});
  const Simulated run(scene);
  const host::RenewalCounts& counts = *scene.computation.renewals();
  EXPECT_GT(counts.beyond, 0);
  EXPECT_GE(counts.words_beyond, counts.beyond);
  EXPECT_GT(counts.growth, 1);
  const std::vector<std::int64_t> frames = due(run, 5);
  EXPECT_EQ(counts.renewed + counts.beyond, static_cast<int>(frames.size()));
  for (const Frame& frame : run.log.frames) {
    const bool flagged =
        stability::Flags(frame.flags).has(stability::Flag::matrix_word_beyond_scale);
    const bool sent = find(frame, Part::fpga, Phase::load_values) != nullptr;
    EXPECT_EQ(flagged || sent, std::ranges::count(frames, frame.number) == 1) << frame.number;
    EXPECT_FALSE(flagged && sent);
  }
  expect_same_words(scene, run.platform);
}

// The bridge tells of a block that nobody claimed. The force of the frame is out; the board is
// reset and loaded with the newest matrix, and told of the contact again.
TEST(Renewal, AFaultInMidTransferLosesTheMatrixAndIsRecovered) {
  PressedScene scene({});
  Fault fault;
  fault.kind = FaultKind::master_abort;
  fault.frame = 14;
  fault.access = FaultAccess::values;
  scene.settings.faults = {fault};
  const Simulated run(scene);
  const ServoCounts& counts = run.platform.servo().counts();
  const ErrorCount& bus = counts.errors[HVP_ERROR_BUS];
  EXPECT_EQ(bus.count, 1);
  EXPECT_EQ(bus.first_frame, 14);
  EXPECT_EQ(counts.recoveries, 1);
  EXPECT_EQ(counts.driver_errors, 0);  // that frame had its force
  ASSERT_NE(run.platform.faults(), nullptr);
  EXPECT_EQ(run.platform.faults()->records().front().injected, 1);
  EXPECT_EQ(run.platform.faults()->records().front().noticed, 1);
  EXPECT_TRUE(run.log.frames[14].solved());
  EXPECT_TRUE(run.log.frames.back().solved());
  expect_same_words(scene, run.platform);
}

TEST(Renewal, ADamagedWordOfTheMatrixIsNamedToo) {
  PressedScene scene({});
  Fault fault;
  fault.kind = FaultKind::corrupted_word;
  fault.frame = 14;
  fault.access = FaultAccess::values;
  scene.settings.faults = {fault};
  const Simulated run(scene);
  const ServoCounts& counts = run.platform.servo().counts();
  EXPECT_EQ(counts.errors[HVP_ERROR_DATA].count, 1);
  EXPECT_EQ(counts.recoveries, 1);
  expect_same_words(scene, run.platform);
}

}  // namespace
}  // namespace hvp::vp::renewal_test
