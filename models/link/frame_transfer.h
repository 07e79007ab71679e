#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "models/config/declaration.h"
#include "models/link/interconnect.h"

namespace hvp::link {

// The words that a frame sends to the board and gets back: b and U.
struct Payload {
  std::int64_t words_to_board = 0;
  std::int64_t words_to_host = 0;
  int word_bits = 16;
  // Two words of up to 16 bits go into one bus word of 32 bits.
  bool packed = true;

  // The bytes of `words` words in whole bus words of 32 bits; a word of more than 16 bits fills
  // one.
  std::int64_t bytes(std::int64_t words) const;
};

// The board's DMA engine: a doorbell starts it, it fetches descriptors from the host's memory,
// moves a segment a descriptor and writes a completion record (DMA_LIST_LOW and DMA_RECORD_LOW in
// docs/registers.md).
struct DmaEngine {
  // Engines for FPGA boards have descriptors of 32 bytes too (Xilinx XDMA, PG195).
  static constexpr int kDescriptorBytes = 32;
  static constexpr int kRecordBytes = 32;

  int segment_bytes = 4096;
  bool prefetches_descriptors = true;
  double engine_latency_s = 200e-9;

  void declare(config::Visitor& v);
  void check() const;
  std::int64_t segments(std::int64_t bytes) const;
};

enum class Movement { programmed_io, write_combined_io, dma };
enum class Notification { polling, intx, msi };

// The way of a frame's transfers. Write-combining serves stores alone: with it results are read
// back word by word.
struct TransferMethod {
  Movement movement = Movement::dma;
  Notification notification = Notification::msi;
  // The time between two polls, for polling. A poll of the board is a read over the bus; with DMA
  // the host polls its own memory, which does not use the bus.
  std::int64_t poll_interval_ps = 0;
};

const char* name(Movement movement);
const char* name(Notification notification);

struct TransferStep {
  std::string_view what;
  Cost cost;
};

// A frame's transfers, one step after the other; the solve is between the two lists. The host's
// computation, its interrupt latency and its caches are not included.
struct FrameTransfer {
  std::vector<TransferStep> to_board;  // steps until the board may start
  std::vector<TransferStep> to_host;   // from the solve's end until the host has U
  // Polling notices the end of the solve half a period late on average, and at worst later than
  // that by this time.
  std::int64_t poll_worst_extra_ps = 0;

  Cost to_board_total() const;
  Cost to_host_total() const;
  Cost total() const { return to_board_total() + to_host_total(); }
};

FrameTransfer frame_transfer(const Interconnect& bus, const DmaEngine& engine,
                             const Payload& payload, const TransferMethod& method);

}  // namespace hvp::link
