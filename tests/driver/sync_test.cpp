// Who owns which memory when: every word that the driver touches is the processor's at that time,
// and every word that the board touches is the board's.
#include <algorithm>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "tests/driver/driver_on_board.h"
#include "vp/fpga/register_bank.h"

namespace hvp::test::sync_test {
namespace {

struct HandOver {
  hvp_area area;
  std::uint64_t address;
  std::uint32_t bytes;
  hvp_owner owner;
  bool operator==(const HandOver&) const = default;
};
void PrintTo(const HandOver& h, std::ostream* out) {
  *out << "area " << h.area << " at word " << (h.address - ScriptedBoard::kMemoryAddress) / 4
       << ", " << h.bytes << " bytes to the "
       << (h.owner == HVP_OWNER_DEVICE ? "device" : "processor");
}

// Memory that is not coherent. The driver works on a copy, its cache; what it does not own is
// scrambled there, and what the board does not own is not in the board's memory. So whatever is
// touched without being handed over comes out wrong.
class DriverWithoutCoherence : public DriverOnBoard {
 protected:
  static constexpr std::size_t kList = 0, kRecord = 64, kWords = 1024;
  static constexpr std::uint32_t kScrambled = 0xdeadbeef;

  DriverWithoutCoherence() {
    to_board = {segment(200, 12), segment(100, 20), segment(140, 40)};
    to_host = {segment(300, 8), segment(500, 4), segment(400, 64)};
    dma.to_board = to_board.data();
    dma.to_board_count = to_board.size();
    dma.to_host = to_host.data();
    dma.to_host_count = to_host.size();
    dma.list = &cache[kList];
    dma.list_address = ScriptedBoard::address(kList);
    dma.record = &cache[kRecord];
    dma.record_address = ScriptedBoard::address(kRecord);
    dma.context = this;
    dma.sync = [](void* context, hvp_area area, const hvp_segment* part, hvp_owner owner) {
      static_cast<DriverWithoutCoherence*>(context)->sync(area, *part, owner);
    };
    board.solve = [](vp::RegisterBank& bank) {
      for (std::size_t i = 0; i < kUnknowns; ++i) {
        const auto element = vp::packed_element(bank.memory(vp::Aperture::b), i, 16);
        vp::set_packed_element(bank.memory(vp::Aperture::u), i, 16, element);
      }
    };
  }
  hvp_segment segment(std::size_t word, std::uint32_t bytes) {
    return {&cache[word], ScriptedBoard::address(word), bytes};
  }
  void sync(hvp_area area, const hvp_segment& part, hvp_owner owner) {
    const std::size_t first = (part.bus_address - ScriptedBoard::kMemoryAddress) / 4;
    // The part is where it says for both.
    ASSERT_EQ(part.memory, &cache[first]);
    for (std::size_t k = first; k < first + part.bytes / 4; ++k) {
      if (owner == HVP_OWNER_PROCESSOR) {
        cache[k] = *board.memory(k);
      } else {
        // A way that only the board writes brings nothing from the processor.
        if (area != HVP_AREA_TO_HOST) *board.memory(k) = cache[k];
        cache[k] = kScrambled;
      }
    }
    log.push_back({area, part.bus_address, part.bytes, owner});
  }
  void load_on(hvp_bus bus) {
    bus.pause = nullptr;
    const hvp_solver_config config = thesis_config();
    const hvp_matrix view = matrix.view();
    ASSERT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_OK);
    ASSERT_EQ(hvp_use_dma(&device, &dma), HVP_OK);
    ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
    ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
  }
  static HandOver hand_over(hvp_area area, std::size_t word, std::uint32_t bytes, hvp_owner owner) {
    return {area, ScriptedBoard::address(word), bytes, owner};
  }
  std::vector<HandOver> take_log() { return std::exchange(log, {}); }

  std::vector<std::uint32_t> cache = std::vector<std::uint32_t>(kWords, kScrambled);
  std::vector<hvp_segment> to_board, to_host;
  hvp_dma dma{};
  std::vector<HandOver> log;
};

TEST_F(DriverWithoutCoherence, FramesComeOutRight) {
  for (const bool message : {false, true}) {
    hvp_bus bus = board.bus();
    bus.interrupts_after_writes = message;
    load_on(bus);
    for (int frame = 0; frame < 3; ++frame) {
      for (std::size_t i = 0; i < b.size(); ++i) b[i] = frame * 100 - static_cast<int>(i);
      ASSERT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
      EXPECT_EQ(u, b);
    }
  }
}

// What is touched and no more: 32 bytes each of b, 12 and 20, and of U, 8, 4 and 20; nothing of the
// segment that is not needed, and a list of two and three descriptors.
TEST_F(DriverWithoutCoherence, AFrameHandsOverWhatItTouches) {
  hvp_bus bus = board.bus();
  bus.interrupts_after_writes = true;
  load_on(bus);
  const auto to = [](hvp_owner owner) {
    return [owner](hvp_area area, std::size_t word, std::uint32_t bytes) {
      return hand_over(area, word, bytes, owner);
    };
  };
  const auto processor = to(HVP_OWNER_PROCESSOR);
  const auto device_s = to(HVP_OWNER_DEVICE);
  using Log = std::vector<HandOver>;
  EXPECT_EQ(take_log(),
            (Log{processor(HVP_AREA_LIST, kList, 5 * 32), device_s(HVP_AREA_LIST, kList, 5 * 32)}));
  ASSERT_EQ(hvp_write_rhs(&device, b.data(), b.size()), HVP_OK);
  EXPECT_EQ(take_log(),
            (Log{processor(HVP_AREA_TO_BOARD, 200, 12), processor(HVP_AREA_TO_BOARD, 100, 20),
                 device_s(HVP_AREA_TO_BOARD, 200, 12), device_s(HVP_AREA_TO_BOARD, 100, 20)}));
  ASSERT_EQ(hvp_start(&device), HVP_OK);
  EXPECT_EQ(take_log(),
            (Log{processor(HVP_AREA_RECORD, kRecord, 32), device_s(HVP_AREA_RECORD, kRecord, 32)}));
  ASSERT_EQ(hvp_wait(&device, kTimeoutNs), HVP_OK);
  // Twice: what is read behind the job's number was written before it.
  EXPECT_EQ(take_log(),
            (Log{processor(HVP_AREA_RECORD, kRecord, 32), processor(HVP_AREA_RECORD, kRecord, 32),
                 device_s(HVP_AREA_RECORD, kRecord, 32)}));
  ASSERT_EQ(hvp_read_solution(&device, u.data(), u.size()), HVP_OK);
  EXPECT_EQ(take_log(),
            (Log{processor(HVP_AREA_TO_HOST, 300, 8), processor(HVP_AREA_TO_HOST, 500, 4),
                 processor(HVP_AREA_TO_HOST, 400, 20), device_s(HVP_AREA_TO_HOST, 300, 8),
                 device_s(HVP_AREA_TO_HOST, 500, 4), device_s(HVP_AREA_TO_HOST, 400, 20)}));
}

// A look in vain gives the record back to the board, which has yet to write it.
TEST_F(DriverWithoutCoherence, ARecordThatIsNotThereIsGivenBack) {
  hvp_bus bus = board.bus();
  bus.interrupts_after_writes = true;
  load_on(bus);
  ASSERT_EQ(hvp_start(&device), HVP_OK);
  ASSERT_EQ(hvp_wait(&device, 1000), HVP_ERROR_TIMEOUT);
  EXPECT_EQ(log.back().owner, HVP_OWNER_DEVICE);
  ASSERT_EQ(hvp_wait(&device, kTimeoutNs), HVP_OK);
}

}  // namespace
}  // namespace hvp::test::sync_test
