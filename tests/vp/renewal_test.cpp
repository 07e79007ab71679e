// Frames after which the board gets the matrix of the deformed body: the words that it has then,
// what the transfer takes to the picosecond, and what a fault in the middle of it leaves.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/tissue/model.h"
#include "tests/vp/child_output.h"
#include "tests/vp/expected_frame.h"
#include "vp/fpga/register_bank.h"
#include "vp/platform.h"

namespace hvp::vp::renewal_test {
namespace {

using test::FrameLog;
using test::kBoardClock;
using test::kUs;
using test::pci_read;
using test::pci_write;
using test::SmallScene;

constexpr Picoseconds kInterrupt = 5 * kUs;
constexpr Picoseconds kDriver = 1 * kUs;

struct Options {
  int renew_every = 5;
  double headroom = 2;
  tissue::LawKind law = tissue::LawKind::neo_hookean_log;
  fixed::Method method = fixed::Method::cg;
};

// The small scene's cube of a law that is not linear, pressed by 8 mm.
struct PressedScene {
  explicit PressedScene(const Options& options)
      : body(fem::structured_box({SmallScene::kEdge, SmallScene::kEdge, SmallScene::kEdge},
                                 {3, 3, 3}),
             fem::Material{}, SmallScene::floor(), fem::AnchorTreatment::removed),
        computation(tissue::make_tissue(body, model(options.law), fem::ContactDiagonal::average,
                                        fem::Dynamics{}, 2e-3, fem::Effort::computed),
                    solver(options.method), host::Refinement{.passes = 1}, host::SolvedBy::board,
                    host::Effort::computed,
                    {.every = options.renew_every, .headroom = options.headroom}),
        contacts(body.mesh(), SmallScene::floor(), {}) {
    settings.solver = computation.board().settings();
    settings.period = to_picoseconds(2e-3);
    settings.budget = settings.period;
    settings.frames = 40;
    settings.host.sustained_rate_flops = 100e9;
    plant::Segment press;
    press.phase = plant::Stroke::press;
    press.to = SmallScene::above(-8e-3);
    press.duration = 60e-3;
    settings.probes.front().interpolation = plant::Interpolation::linear;
    settings.probes.front().start = SmallScene::above(-0.5e-3);
    settings.probes.front().motion = {press};
  }

  static std::optional<tissue::Model> model(tissue::LawKind law) {
    tissue::Model model;
    model.kind = law;
    return model;
  }
  static fixed::Settings solver(fixed::Method method) {
    fixed::Settings settings;
    settings.method = method;
    return settings;
  }

  fem::Body body;
  host::FrameComputation computation;
  collision::ContactSearch contacts;
  PlatformSettings settings;
};

struct Simulated {
  explicit Simulated(PressedScene& scene)
      : platform(scene.settings, scene.body, scene.computation, scene.contacts) {
    platform.add_observer(log);
    platform.run();
  }
  FrameLog log;
  Platform platform;
};

const Span* find(const Frame& frame, Part part, Phase phase) {
  const auto found = std::ranges::find_if(
      frame.spans, [&](const Span& s) { return s.part == part && s.phase == phase; });
  return found == frame.spans.end() ? nullptr : &*found;
}

// The board's words are those that the host has, but for the contact.
void expect_same_words(const PressedScene& scene, const Platform& platform) {
  fixed::QuantisedMatrix expected = scene.computation.board().matrix();
  ASSERT_FALSE(scene.computation.contact().empty());
  for (const int node : scene.computation.contact()) {
    expected.set_contact(node, scene.computation.board().diagonal_word());
  }
  const RegisterBank& bank = platform.accelerator().bank();
  for (std::size_t i = 0; i < expected.value.size(); ++i) {
    ASSERT_EQ(packed_element(bank.memory(Aperture::value), i, 12), expected.value[i]) << i;
  }
  EXPECT_EQ(bank.get(field::kStatusMatrixLoaded), 1U);
  EXPECT_EQ(platform.accelerator().illegal_accesses(), 0);
}

// The values in blocks as long as the driver's scratch area, which holds b: 144 words.
Picoseconds blocks_of(std::size_t entries, const std::function<Picoseconds(int)>& block) {
  Picoseconds sum = 0;
  for (int words = static_cast<int>(entries / 2); words > 0; words -= SmallScene::kUnknowns) {
    sum += block(4 * std::min(words, SmallScene::kUnknowns));
  }
  return sum;
}

// The frames after which a renewal is due: the board solves from the frame on in which the probe
// touches.
std::vector<std::int64_t> due(const Simulated& run, int every) {
  std::vector<std::int64_t> frames;
  int solved = 0;
  for (const Frame& frame : run.log.frames) {
    if (find(frame, Part::fpga, Phase::solve) == nullptr) continue;
    if (++solved % every == 0) frames.push_back(frame.number);
  }
  EXPECT_GT(solved, 30);
  EXPECT_LT(solved, 40);
  return frames;
}

// What a frame's work takes after the matrix is assembled.
void expect_transfer(PressedScene& scene, const Simulated& run, int every, Picoseconds expected) {
  const std::vector<std::int64_t> expected_frames = due(run, every);
  int renewed = 0;
  for (const Frame& frame : run.log.frames) {
    const Span* const assemble = find(frame, Part::host, Phase::assemble);
    EXPECT_EQ(assemble != nullptr, std::ranges::count(expected_frames, frame.number) == 1)
        << frame.number;
    if (assemble == nullptr) continue;
    EXPECT_EQ(frame.work_done - assemble->end, expected) << frame.number;
    // The force was on its way: the DAQ converts it beside the host.
    EXPECT_LT(frame.latency() - 10 * kUs, assemble->start - frame.born);
    ++renewed;
  }
  EXPECT_EQ(renewed, 7);
  ASSERT_NE(scene.computation.renewals(), nullptr);
  EXPECT_EQ(scene.computation.renewals()->renewed, renewed);
  expect_same_words(scene, run.platform);
}

Picoseconds around(Picoseconds job) {
  return kDriver + pci_write(4) + job + kInterrupt + pci_read(4) + pci_write(4);
}

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

// A DMA engine moves b and U; the values remain the processor's.
TEST(Renewal, TakesItsBlocksBesideADmaEngine) {
  PressedScene scene({});
  scene.settings.transfer.method = Transfer::Method::dma;
  scene.settings.transfer.dma.emplace();
  const std::size_t entries = scene.computation.board().matrix().value.size();
  const Simulated run(scene);
  expect_transfer(scene, run, 5, around(kBoardClock) + blocks_of(entries, pci_write));
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
