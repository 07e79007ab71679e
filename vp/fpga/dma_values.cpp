// The engine's way to VALUE: a list of its own, and the faults that may strike it.
#include <algorithm>
#include <cstring>
#include <utility>

#include "models/time/picoseconds.h"
#include "vp/fpga/dma_engine.h"

namespace hvp::vp {

void DmaEngine::fetch_values(const Tag& tag) {
  ring(tag);
  rung_for_values_ = true;
}

// A reset gives the list up wherever it is.
void DmaEngine::run_values() {
  const std::uint64_t generation = generation_;
  tag_ = std::exchange(rung_tag_, Tag{});
  ++lists_;
  let_latency_pass(rung_at_);
  if (generation != generation_) return;
  const BoardError error = move_values(bank_.get(field::kDmaValuesCountCount));
  if (generation != generation_) return;
  owner_.values_fetched(error, tag_);
  let_go(tag_);
}

// The list may be longer than the engine's memory for descriptors, which it fills anew then.
BoardError DmaEngine::move_values(std::uint32_t count) {
  const std::uint64_t generation = generation_;
  const std::uint64_t list =
      address_of(bank_.get(Register::dma_values_low), bank_.get(Register::dma_values_high));
  const std::uint32_t at_once = settings_.dma->prefetches_descriptors ? kMaxDescriptors : 1;
  for (std::uint32_t place = 0; place < count; ++place) {
    if (place % at_once == 0) {
      const BoardError error = fetch(list, place, std::min(at_once, count - place));
      if (error.code != ErrorCode::none || generation != generation_) return error;
    }
    const std::optional<Descriptor> descriptor = parse(Way::values, place);
    if (!descriptor) return {ErrorCode::bad_descriptor, place};
    const bool moved = move_values_segment(*descriptor);
    if (generation != generation_) return {};
    if (!moved) return {ErrorCode::dma_failed, place};
  }
  return {};
}

// A word that the board knows to be damaged does not reach VALUE.
bool DmaEngine::move_values_segment(const Descriptor& d) {
  const std::uint64_t generation = generation_;
  if (segment_.size() < d.bytes) segment_.resize(d.bytes);
  const std::span<std::uint8_t> data = std::span(segment_).first(d.bytes);
  if (!transport(MasterPurpose::values, d.address, data, tag_)) return false;
  if (generation != generation_) return false;
  const bool sound = faults_ == nullptr || survive_faults(data);
  if (!sound || generation != generation_) return false;
  std::memcpy(on_board(Way::values, d.offset), data.data(), data.size());
  return true;
}

// What a fault of this frame has made of a segment of values. As at the other end of the wire
// (vp/board/faulty_wire.h), nobody answers a read that is aborted, parity finds an odd number of
// flipped bits, and the link of PCI Express brings every damaged packet again.
bool DmaEngine::survive_faults(std::span<std::uint8_t> data) {
  const std::int64_t frame = tag_.frame;
  const auto strikes = [this, frame](FaultKind kind) {
    return faults_->strike(kind, frame, FaultAccess::values);
  };
  if (strikes(FaultKind::surprise_removal) != nullptr) {
    faults_->remove();
    return false;
  }
  if (strikes(FaultKind::master_abort) != nullptr) return false;
  if (link_ != nullptr && strikes(FaultKind::aer_uncorrectable) != nullptr) {
    faults_->tell_of_packet_error(FaultKind::aer_uncorrectable);
    return false;
  }
  if (link_ != nullptr) {
    if (const Fault* const bad = strikes(FaultKind::aer_correctable); bad != nullptr) {
      faults_->tell_of_packet_error(bad->kind);
      come_again(*bad, data.size());
      return true;
    }
  }
  const Fault* const corrupted = strikes(FaultKind::corrupted_word);
  if (corrupted == nullptr) return true;
  if (link_ != nullptr) {
    come_again(*corrupted, data.size());
    return true;
  }
  const auto words = static_cast<std::uint32_t>(data.size() / 4);
  const std::size_t at = 4 * std::size_t{faults_->word(*corrupted, frame, words)};
  std::uint32_t word = 0;
  std::memcpy(&word, &data[at], sizeof word);
  word ^= faults_->mask(*corrupted, frame);
  std::memcpy(&data[at], &word, sizeof word);
  return corrupted->flipped_bits() % 2 == 0;
}

// The receiver's Nak takes the packet's way back, and the packet comes again (PCIe 5.0 §3.6.2).
void DmaEngine::come_again(const Fault& fault, std::size_t bytes) {
  faults_->correct(fault);
  const std::int64_t packet =
      std::min<std::int64_t>(static_cast<std::int64_t>(bytes), link_->completion_bytes());
  const Picoseconds since = now_ps();
  wait(to_sc_time(2 * link_->link_ps() + link_->transfer_ps(link_->completion_wire_bytes(packet))));
  ledger_.extend(tag_, Part::bus, Phase::dma_read, since, now_ps());
}

}  // namespace hvp::vp
