// The values of a renewed matrix by the board's DMA engine, and over PCI Express either way: to the
// picosecond, on PCI counted out, on PCI Express by the closed form of models/link.
#include <algorithm>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "models/link/interconnect.h"
#include "tests/vp/child_output.h"
#include "tests/vp/pressed_scene.h"
#include "vp/fpga/dma_engine.h"

namespace hvp::vp::renewal_transfer_test {
namespace {

using link::Notification;
using test::expect_transfer;
using test::kBoardClock;
using test::kDriverTime;
using test::kInterruptLatency;
using test::kNs;
using test::pci_read;
using test::pci_write;
using test::PressedScene;
using test::SimulatedRenewal;
using Method = Transfer::Method;

constexpr Picoseconds kEngine = 200 * kNs;
constexpr int kEvery = 5;
constexpr int kDescriptor = 32;

// The board's bursts on PCI 32/33, without the processor's way.
Picoseconds board_write(int bytes) { return test::pci(bytes, 4, 0); }
Picoseconds board_read(int bytes) { return test::pci(bytes, 4 + 8, 0); }

// 12-bit entries travel two in a word.
int value_bytes(const PressedScene& scene) {
  return static_cast<int>(scene.computation.board().matrix().value.size()) / 2 * 4;
}

template <class Move>
Picoseconds in_segments(int bytes, int segment, const Move& move) {
  Picoseconds sum = 0;
  for (int left = bytes; left > 0; left -= segment) sum += move(std::min(left, segment));
  return sum;
}

void by_dma(PressedScene& scene, Notification notification) {
  scene.settings.transfer.method = Method::dma;
  scene.settings.transfer.notification = notification;
  scene.settings.transfer.dma.emplace();
}

TEST(RenewalByDma, IsTwoReadsOfTheBoardAndItsInterrupt) {
  PressedScene scene({});
  by_dma(scene, Notification::intx);
  const int bytes = value_bytes(scene);
  ASSERT_GT(bytes, 4096);
  const int segments = (bytes + 4095) / 4096;
  const SimulatedRenewal run(scene);
  expect_transfer(scene, run, kEvery,
                  kDriverTime + pci_write(4) + kEngine + board_read(kDescriptor * segments) +
                      in_segments(bytes, 4096, board_read) + kBoardClock + kInterruptLatency +
                      pci_read(4) + pci_write(4));
}

// The job's end, which its message has told, is acknowledged first: STATUS.done is to be the
// values'.
TEST(RenewalByDma, WithMessages) {
  PressedScene scene({});
  by_dma(scene, Notification::msi);
  const int bytes = value_bytes(scene);
  const int segments = (bytes + 4095) / 4096;
  const SimulatedRenewal run(scene);
  expect_transfer(scene, run, kEvery,
                  kDriverTime + pci_write(4) + pci_write(4) + kEngine +
                      board_read(kDescriptor * segments) + in_segments(bytes, 4096, board_read) +
                      kBoardClock + board_write(4) + kInterruptLatency + pci_read(4) +
                      pci_write(4));
}

// 256 descriptors fit into the engine's memory.
TEST(RenewalByDma, AListThatIsLongerThanTheEnginesMemory) {
  PressedScene scene({});
  by_dma(scene, Notification::intx);
  constexpr int kSegment = 24;
  scene.settings.transfer.dma->segment_bytes = kSegment;
  const int bytes = value_bytes(scene);
  const int segments = (bytes + kSegment - 1) / kSegment;
  constexpr int kMost = DmaEngine::kMaxDescriptors;
  ASSERT_GT(segments, kMost);
  const SimulatedRenewal run(scene);
  expect_transfer(scene, run, kEvery,
                  kDriverTime + pci_write(4) + kEngine +
                      in_segments(kDescriptor * segments, kDescriptor * kMost, board_read) +
                      in_segments(bytes, kSegment, board_read) + kBoardClock + kInterruptLatency +
                      pci_read(4) + pci_write(4));
}

TEST(RenewalByDma, ADescriptorAtATime) {
  PressedScene scene({});
  by_dma(scene, Notification::intx);
  scene.settings.transfer.dma->prefetches_descriptors = false;
  const int bytes = value_bytes(scene);
  const int segments = (bytes + 4095) / 4096;
  const SimulatedRenewal run(scene);
  expect_transfer(scene, run, kEvery,
                  kDriverTime + pci_write(4) + kEngine + segments * board_read(kDescriptor) +
                      in_segments(bytes, 4096, board_read) + kBoardClock + kInterruptLatency +
                      pci_read(4) + pci_write(4));
}

// 48 nodes of three divisions, 68 clocks each; the pipeline of 20.
TEST(RenewalByDma, TakesTheDivisionsOfJacobisPreconditionerAtEveryLevel) {
  for (const Timing level :
       {Timing::loosely_timed, Timing::approximately_timed, Timing::cycle_accurate}) {
    const std::string outcome = test::output_of_child([level](std::string& out) {
      PressedScene scene({.method = fixed::Method::jacobi_pcg});
      by_dma(scene, Notification::intx);
      scene.settings.fidelity.accelerator = level;
      const int bytes = value_bytes(scene);
      const int segments = (bytes + 4095) / 4096;
      const SimulatedRenewal run(scene);
      expect_transfer(scene, run, kEvery,
                      kDriverTime + pci_write(4) + kEngine + board_read(kDescriptor * segments) +
                          in_segments(bytes, 4096, board_read) + (48 * 3 * 68 + 20) * kBoardClock +
                          kInterruptLatency + pci_read(4) + pci_write(4));
      out = testing::Test::HasFailure() ? "failed" : "passed";
    });
    EXPECT_EQ(outcome, "passed") << static_cast<int>(level);
  }
}

// What follows the values' last word on the link: the command, the board, its message, STATUS and
// the acknowledgement.
Picoseconds end_on_pcie(const link::PcieInterconnect& link) {
  return kBoardClock + link.interrupt(link::Interrupt::msi).latency_ps + kInterruptLatency +
         link.processor_read(4).latency_ps + link.processor_write(4, false).processor_ps;
}

// Blocks as long as the driver's scratch area, which holds b. A block is posted: the processor goes
// on when the link can take the next store, and the command arrives behind them all.
void expect_blocks_on_pcie(Method method, bool combined) {
  PressedScene scene({});
  scene.settings.bus.pcie.emplace();
  scene.settings.transfer.method = method;
  scene.settings.transfer.notification = Notification::msi;
  const link::PcieInterconnect link(*scene.settings.bus.pcie);
  const SimulatedRenewal run(scene);
  expect_transfer(scene, run, kEvery,
                  kDriverTime +
                      in_segments(value_bytes(scene), 4 * test::SmallScene::kUnknowns,
                                  [&](int bytes) {
                                    return link.processor_write(bytes, combined).processor_ps;
                                  }) +
                      link.processor_write(4, false).latency_ps + end_on_pcie(link));
}

TEST(RenewalOnPcie, TakesItsBlocksInCombinedWrites) {
  expect_blocks_on_pcie(Method::write_combined_io, true);
}

TEST(RenewalOnPcie, TakesItsWordsByProgrammedIo) {
  expect_blocks_on_pcie(Method::programmed_io, false);
}

TEST(RenewalOnPcie, IsFetchedByDma) {
  PressedScene scene({});
  scene.settings.bus.pcie.emplace();
  by_dma(scene, Notification::msi);
  const link::PcieInterconnect link(*scene.settings.bus.pcie);
  const int bytes = value_bytes(scene);
  const int segments = (bytes + 4095) / 4096;
  const SimulatedRenewal run(scene);
  const Picoseconds acknowledge = link.processor_write(4, false).processor_ps;
  expect_transfer(
      scene, run, kEvery,
      kDriverTime + acknowledge + link.processor_write(4, false).latency_ps + kEngine +
          link.dma_read(kDescriptor * segments).latency_ps +
          in_segments(bytes, 4096, [&](int part) { return link.dma_read(part).latency_ps; }) +
          end_on_pcie(link));
}

}  // namespace
}  // namespace hvp::vp::renewal_transfer_test
