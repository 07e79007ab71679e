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
constexpr std::size_t kMostOfValues = (1U << field::kDmaValuesCountCount.width) - 1;
constexpr std::size_t kSegmentsAt = kListAt + 4 * kDescriptorWords * DmaEngine::kMaxDescriptors;

std::size_t segments(const link::DmaEngine& engine, std::size_t bytes) {
  return static_cast<std::size_t>(engine.segments(static_cast<std::int64_t>(bytes)));
}

std::size_t whole_lines(std::size_t bytes) { return (bytes + kLine - 1) / kLine * kLine; }

// The distance between the beginnings of two segments.
std::size_t stride(const link::DmaEngine& engine, std::size_t longest) {
  return whole_lines(std::min(static_cast<std::size_t>(engine.segment_bytes), longest));
}

// Where the list of the values begins, which their segments follow.
std::size_t values_list_at(const link::DmaEngine& engine, const DmaBytes& bytes) {
  const std::size_t slots = 2 * std::max(segments(engine, bytes.b), segments(engine, bytes.u));
  return kSegmentsAt + slots * stride(engine, std::max(bytes.b, bytes.u));
}

std::size_t values_at(const link::DmaEngine& engine, const DmaBytes& bytes) {
  return values_list_at(engine, bytes) +
         whole_lines(4 * kDescriptorWords * segments(engine, bytes.values));
}

}  // namespace

DmaBytes DmaBytes::of(const Transfer& transfer, const fixed::Settings& solver, std::size_t unknowns,
                      std::size_t renewed_entries) {
  return {transfer.rhs_bytes(solver, unknowns), transfer.solution_bytes(solver, unknowns),
          transfer.values_bytes(solver, renewed_entries)};
}

std::size_t DmaMemory::needed(const link::DmaEngine& engine, const DmaBytes& bytes) {
  return values_at(engine, bytes) + segments(engine, bytes.values) * stride(engine, bytes.values);
}

DmaMemory::DmaMemory(HostMemory& memory, const link::DmaEngine& engine, const DmaBytes& bytes) {
  const std::size_t descriptors = segments(engine, bytes.b) + segments(engine, bytes.u);
  if (descriptors > DmaEngine::kMaxDescriptors) {
    throw InputError("transfer.dma.segment_bytes",
                     "b and U of " + std::to_string(bytes.b) + " and " + std::to_string(bytes.u) +
                         " bytes are " + std::to_string(descriptors) +
                         " segments: expected at most " +
                         std::to_string(DmaEngine::kMaxDescriptors) + ", in larger ones");
  }
  if (segments(engine, bytes.values) > kMostOfValues) {
    throw InputError("transfer.dma.segment_bytes",
                     "the matrix' values of " + std::to_string(bytes.values) + " bytes are " +
                         std::to_string(segments(engine, bytes.values)) +
                         " segments: expected at most " + std::to_string(kMostOfValues) +
                         ", in larger ones");
  }
  if (memory.bytes().size() < needed(engine, bytes)) {
    throw std::logic_error("the host's memory has no room for its segments");
  }
  const auto words_at = [&memory](std::size_t address) {
    return reinterpret_cast<std::uint32_t*>(memory.bytes().data() + address);
  };
  const std::size_t step = stride(engine, std::max(bytes.b, bytes.u));
  const auto lay_out = [&](std::vector<hvp_segment>& out, std::size_t length, std::size_t first,
                           std::size_t apart) {
    const auto most = static_cast<std::size_t>(engine.segment_bytes);
    for (std::size_t address = first, done = 0; done < length; address += apart) {
      const std::size_t part = std::min(most, length - done);
      out.push_back({words_at(address), address, static_cast<std::uint32_t>(part)});
      done += part;
    }
  };
  lay_out(to_board_, bytes.b, kSegmentsAt, 2 * step);
  lay_out(to_host_, bytes.u, kSegmentsAt + step, 2 * step);
  lay_out(values_, bytes.values, values_at(engine, bytes), stride(engine, bytes.values));
  dma_.to_board = to_board_.data();
  dma_.to_board_count = to_board_.size();
  dma_.to_host = to_host_.data();
  dma_.to_host_count = to_host_.size();
  dma_.list = words_at(kListAt);
  dma_.list_address = kListAt;
  dma_.record = words_at(kRecordAt);
  dma_.record_address = kRecordAt;
  if (values_.empty()) return;
  dma_.values = values_.data();
  dma_.values_count = values_.size();
  dma_.values_list_address = values_list_at(engine, bytes);
  dma_.values_list = words_at(dma_.values_list_address);
}

}  // namespace hvp::vp
