#include "vp/host/dma_memory.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "models/config/input_error.h"
#include "vp/fpga/dma_engine.h"

namespace hvp::vp {

namespace {

constexpr std::size_t kLine = 64;  // of a cache: nothing shares one
constexpr std::size_t kRecordAt = 0;
constexpr std::size_t kListAt = kLine;
constexpr std::size_t kSegmentsAt = kListAt + 4 * kDescriptorWords * DmaEngine::kMaxDescriptors;

std::size_t segments(const link::DmaEngine& engine, std::size_t bytes) {
  return static_cast<std::size_t>(engine.segments(static_cast<std::int64_t>(bytes)));
}

// The distance between the beginnings of two segments.
std::size_t stride(const link::DmaEngine& engine, std::size_t longest) {
  const std::size_t bytes = std::min(static_cast<std::size_t>(engine.segment_bytes), longest);
  return (bytes + kLine - 1) / kLine * kLine;
}

}  // namespace

std::size_t DmaMemory::needed(const link::DmaEngine& engine, std::size_t b_bytes,
                              std::size_t u_bytes) {
  const std::size_t slots = 2 * std::max(segments(engine, b_bytes), segments(engine, u_bytes));
  return kSegmentsAt + slots * stride(engine, std::max(b_bytes, u_bytes));
}

std::size_t DmaMemory::needed(const Transfer& transfer, const fixed::Settings& solver,
                              std::size_t unknowns) {
  if (transfer.method != Transfer::Method::dma) return 0;
  return needed(transfer.engine(), transfer.rhs_bytes(solver, unknowns),
                transfer.solution_bytes(solver, unknowns));
}

DmaMemory::DmaMemory(HostMemory& memory, const link::DmaEngine& engine, std::size_t b_bytes,
                     std::size_t u_bytes) {
  const std::size_t descriptors = segments(engine, b_bytes) + segments(engine, u_bytes);
  if (descriptors > DmaEngine::kMaxDescriptors) {
    throw InputError("transfer.dma.segment_bytes",
                     "b and U of " + std::to_string(b_bytes) + " and " + std::to_string(u_bytes) +
                         " bytes are " + std::to_string(descriptors) +
                         " segments: expected at most " +
                         std::to_string(DmaEngine::kMaxDescriptors) + ", in larger ones");
  }
  if (memory.bytes().size() < needed(engine, b_bytes, u_bytes)) {
    throw std::logic_error("the host's memory has no room for its segments");
  }
  const auto words_at = [&memory](std::size_t address) {
    return reinterpret_cast<std::uint32_t*>(memory.bytes().data() + address);
  };
  const std::size_t step = stride(engine, std::max(b_bytes, u_bytes));
  const auto lay_out = [&](std::vector<hvp_segment>& out, std::size_t bytes, std::size_t first) {
    const auto most = static_cast<std::size_t>(engine.segment_bytes);
    for (std::size_t slot = first, done = 0; done < bytes; slot += 2) {
      const std::size_t part = std::min(most, bytes - done);
      const std::size_t address = kSegmentsAt + slot * step;
      out.push_back({words_at(address), address, static_cast<std::uint32_t>(part)});
      done += part;
    }
  };
  lay_out(to_board_, b_bytes, 0);
  lay_out(to_host_, u_bytes, 1);
  dma_.to_board = to_board_.data();
  dma_.to_board_count = to_board_.size();
  dma_.to_host = to_host_.data();
  dma_.to_host_count = to_host_.size();
  dma_.list = words_at(kListAt);
  dma_.list_address = kListAt;
  dma_.record = words_at(kRecordAt);
  dma_.record_address = kRecordAt;
}

}  // namespace hvp::vp
