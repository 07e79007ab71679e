#include "models/link/frame_transfer.h"

#include <algorithm>
#include <string>

#include "models/config/input_error.h"
#include "models/time/picoseconds.h"

namespace hvp::link {

namespace {

Cost sum(const std::vector<TransferStep>& steps) {
  Cost total;
  for (const TransferStep& step : steps) total += step.cost;
  return total;
}

// The engine works on one segment after the other. With prefetching it has fetched all descriptors,
// those of both ways, in one read before the first.
void dma_block(std::vector<TransferStep>& steps, const Interconnect& bus, const DmaEngine& engine,
               std::int64_t bytes, Direction direction) {
  const std::int64_t segments = engine.segments(bytes);
  Cost descriptors;
  Cost data;
  for (std::int64_t k = 0; k < segments; ++k) {
    const std::int64_t segment =
        std::min<std::int64_t>(bytes - k * engine.segment_bytes, engine.segment_bytes);
    data += direction == Direction::read ? bus.dma_read(segment) : bus.dma_write(segment);
    if (!engine.prefetches_descriptors) descriptors += bus.dma_read(DmaEngine::kDescriptorBytes);
  }
  if (!engine.prefetches_descriptors) steps.push_back({"descriptors", descriptors});
  steps.push_back({direction == Direction::read ? "DMA read" : "DMA write", data});
}

// A poll that the board answers just before the solve's end is in vain: the next one comes a
// period later, so that half a period is lost on average, and then the answer's way back. The
// polls in vain before are the processor's time too, but they are the waiting it has chosen.
void poll_board(FrameTransfer& transfer, const Interconnect& bus, std::int64_t interval) {
  Cost poll = bus.processor_read(kWordBytes);
  const std::int64_t period = std::max(poll.latency_ps, interval);
  const std::int64_t answer = poll.latency_ps / 2;
  transfer.poll_worst_extra_ps = period - period / 2;
  poll.latency_ps = period / 2 + answer;
  transfer.to_host.push_back({"polling", poll});
}

void notify(FrameTransfer& transfer, const Interconnect& bus, const TransferMethod& method) {
  switch (method.notification) {
    case Notification::msi:
      transfer.to_host.push_back({"MSI", bus.interrupt(Interrupt::msi)});
      return;
    case Notification::intx:
      transfer.to_host.push_back({"INTx", bus.interrupt(Interrupt::intx)});
      transfer.to_host.push_back({"status read", bus.processor_read(kWordBytes)});
      transfer.to_host.push_back({"acknowledge", bus.processor_write(kWordBytes, false)});
      return;
    case Notification::polling:
      if (method.movement != Movement::dma) {
        poll_board(transfer, bus, method.poll_interval_ps);
        return;
      }
      transfer.to_host.push_back({"polling", {method.poll_interval_ps / 2, 0, 0, 0, 0}});
      transfer.poll_worst_extra_ps = method.poll_interval_ps - method.poll_interval_ps / 2;
  }
}

}  // namespace

std::int64_t Payload::bytes(std::int64_t words) const {
  const std::int64_t in_a_word = packed && word_bits <= 16 ? 2 : 1;
  return (words + in_a_word - 1) / in_a_word * kWordBytes;
}

void DmaEngine::declare(config::Visitor& v) {
  v.integer(
      "segment_bytes", segment_bytes, {64, 1 << 24},
      {"longest run of bytes that lie together in the host's memory, a multiple of 4; each has "
       "a descriptor of 32 bytes",
       "a page of x86"});
  v.boolean(
      "prefetches_descriptors", prefetches_descriptors,
      {"all descriptors of a frame are fetched in one read; otherwise each before its segment",
       "descriptors that lie together can be (PG195)"});
  v.quantity("engine_latency", engine_latency_s, config::Dimension::time, config::between(0, 1e-3),
             {"from the doorbell's arrival to the first request of the engine",
              "unverified: 20 clocks at 100 MHz"});
}

void DmaEngine::check() const {
  if (segment_bytes % kWordBytes == 0) return;
  throw InputError("segment_bytes",
                   "expected a multiple of 4, found " + std::to_string(segment_bytes));
}

std::int64_t DmaEngine::segments(std::int64_t bytes) const {
  return (bytes + segment_bytes - 1) / segment_bytes;
}

const char* name(Movement movement) {
  switch (movement) {
    case Movement::programmed_io:
      return "programmed I/O";
    case Movement::write_combined_io:
      return "programmed I/O, writes combined";
    case Movement::dma:
      return "DMA";
  }
  return "";
}

const char* name(Notification notification) {
  switch (notification) {
    case Notification::polling:
      return "polling";
    case Notification::intx:
      return "INTx";
    case Notification::msi:
      return "MSI";
  }
  return "";
}

Cost FrameTransfer::to_board_total() const { return sum(to_board); }
Cost FrameTransfer::to_host_total() const { return sum(to_host); }

FrameTransfer frame_transfer(const Interconnect& bus, const DmaEngine& engine,
                             const Payload& payload, const TransferMethod& method) {
  const std::int64_t to_board = payload.bytes(payload.words_to_board);
  const std::int64_t to_host = payload.bytes(payload.words_to_host);
  FrameTransfer transfer;
  if (method.movement == Movement::dma) {
    const std::int64_t latency = to_picoseconds(engine.engine_latency_s);
    transfer.to_board.push_back({"doorbell", bus.processor_write(kWordBytes, false)});
    transfer.to_board.push_back({"engine", {latency, 0, 0, 0, 0}});
    if (engine.prefetches_descriptors) {
      const std::int64_t count = engine.segments(to_board) + engine.segments(to_host);
      transfer.to_board.push_back(
          {"descriptors", bus.dma_read(DmaEngine::kDescriptorBytes * count)});
    }
    dma_block(transfer.to_board, bus, engine, to_board, Direction::read);
    transfer.to_host.push_back({"engine", {latency, 0, 0, 0, 0}});
    dma_block(transfer.to_host, bus, engine, to_host, Direction::write);
    transfer.to_host.push_back({"record", bus.dma_write(DmaEngine::kRecordBytes)});
    notify(transfer, bus, method);
    return transfer;
  }
  const bool combined = method.movement == Movement::write_combined_io;
  transfer.to_board.push_back({"write", bus.processor_write(to_board, combined)});
  // Behind the block and, being posted, in its order.
  transfer.to_board.push_back({"start", bus.processor_write(kWordBytes, false)});
  notify(transfer, bus, method);
  transfer.to_host.push_back({"read", bus.processor_read(to_host)});
  return transfer;
}

}  // namespace hvp::link
