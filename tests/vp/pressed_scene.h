#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "models/tissue/model.h"
#include "tests/vp/expected_frame.h"
#include "vp/fpga/register_bank.h"
#include "vp/platform.h"

// A run whose solver gets the matrix of the deformed body now and then, and what that takes.
namespace hvp::test {

inline constexpr vp::Picoseconds kInterruptLatency = 5 * kUs;
inline constexpr vp::Picoseconds kDriverTime = 1 * kUs;

struct RenewalOptions {
  int renew_every = 5;
  double headroom = 2;
  tissue::LawKind law = tissue::LawKind::neo_hookean_log;
  fixed::Method method = fixed::Method::cg;
  host::SolvedBy solved_by = host::SolvedBy::board;
};

// The small scene's cube of a law that is not linear, pressed by 8 mm.
struct PressedScene {
  explicit PressedScene(const RenewalOptions& options)
      : body(fem::structured_box({SmallScene::kEdge, SmallScene::kEdge, SmallScene::kEdge},
                                 {3, 3, 3}),
             fem::Material{}, SmallScene::floor(), fem::AnchorTreatment::removed),
        computation(tissue::make_tissue(body, model(options.law), fem::ContactDiagonal::average,
                                        fem::Dynamics{}, 2e-3, fem::Effort::computed),
                    solver(options.method), host::Refinement{.passes = 1}, options.solved_by,
                    host::Effort::computed,
                    {.every = options.renew_every, .headroom = options.headroom}),
        contacts(body.mesh(), SmallScene::floor(), {.kind = collision::ContactKind::node}) {
    settings.solver =
        computation.has_board() ? computation.board().settings() : solver(options.method);
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
  vp::PlatformSettings settings;
};

struct SimulatedRenewal {
  explicit SimulatedRenewal(PressedScene& scene)
      : platform(scene.settings, scene.body, scene.computation, scene.contacts) {
    platform.add_observer(log);
    platform.run();
  }
  FrameLog log;
  vp::Platform platform;
};

inline const vp::Span* find(const vp::Frame& frame, vp::Part part, vp::Phase phase) {
  const auto found = std::ranges::find_if(
      frame.spans, [&](const vp::Span& s) { return s.part == part && s.phase == phase; });
  return found == frame.spans.end() ? nullptr : &*found;
}

// The board's words are those that the host has, but for the contact.
inline void expect_same_words(const PressedScene& scene, const vp::Platform& platform) {
  fixed::QuantisedMatrix expected = scene.computation.board().matrix();
  ASSERT_FALSE(scene.computation.contact().empty());
  for (const int node : scene.computation.contact()) {
    expected.set_contact(node, scene.computation.board().diagonal_word());
  }
  const vp::RegisterBank& bank = platform.accelerator().bank();
  for (std::size_t i = 0; i < expected.value.size(); ++i) {
    ASSERT_EQ(vp::packed_element(bank.memory(vp::Aperture::value), i, 12), expected.value[i]) << i;
  }
  EXPECT_EQ(bank.get(vp::field::kStatusMatrixLoaded), 1U);
  EXPECT_EQ(platform.accelerator().illegal_accesses(), 0);
}

// The values in blocks as long as the driver's scratch area, which holds b: 144 words.
inline vp::Picoseconds blocks_of(std::size_t entries,
                                 const std::function<vp::Picoseconds(int)>& block) {
  vp::Picoseconds sum = 0;
  for (int words = static_cast<int>(entries / 2); words > 0; words -= SmallScene::kUnknowns) {
    sum += block(4 * std::min(words, SmallScene::kUnknowns));
  }
  return sum;
}

// The frames after which a renewal is due: the board solves from the frame on in which the probe
// touches.
inline std::vector<std::int64_t> due(const SimulatedRenewal& run, int every) {
  std::vector<std::int64_t> frames;
  int solved = 0;
  for (const vp::Frame& frame : run.log.frames) {
    if (find(frame, vp::Part::fpga, vp::Phase::solve) == nullptr) continue;
    if (++solved % every == 0) frames.push_back(frame.number);
  }
  EXPECT_GT(solved, 30);
  EXPECT_LT(solved, 40);
  return frames;
}

// What a frame's work takes after the matrix is assembled.
inline void expect_transfer(PressedScene& scene, const SimulatedRenewal& run, int every,
                            vp::Picoseconds expected) {
  const std::vector<std::int64_t> expected_frames = due(run, every);
  int renewed = 0;
  for (const vp::Frame& frame : run.log.frames) {
    const vp::Span* const assemble = find(frame, vp::Part::host, vp::Phase::assemble);
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

inline vp::Picoseconds around(vp::Picoseconds job) {
  return kDriverTime + pci_write(4) + job + kInterruptLatency + pci_read(4) + pci_write(4);
}

}  // namespace hvp::test
