// The part of PciBus for the effect [bus.posted_writes].
#include <algorithm>

#include "vp/bus/bus_transaction.h"
#include "vp/pci/pci_bus.h"

namespace hvp::vp {

namespace {

// Bytes of a block that leave the bridge, in whole bursts, before the rest fits into its buffer.
std::int64_t beyond_buffer(std::int64_t bytes, std::int64_t buffer, std::int64_t burst) {
  if (bytes <= buffer) return 0;
  return std::min(bytes, (bytes - buffer + burst - 1) / burst * burst);
}

}  // namespace

// Waits in the processor's process until the bridge has the write, or the part of it that does not
// fit into the buffer.
void PciBus::post(tlm::tlm_generic_payload& transaction) {
  Tag none;
  Tag& tag = tag_of(transaction, none);
  const Picoseconds began = now_ps();
  wait(to_sc_time(untimed_ ? 0 : way_to_bus(link::Direction::write)));
  while (posting_->down.full()) wait(posting_->changed);
  const std::size_t bytes = transaction.get_data_length();
  PostedWrite& write =
      posting_->down.push(transaction.get_address(), transaction.get_data_ptr(), bytes);
  write.tag = tag;
  write.phase = processors_phase(transaction);
  write.began = began;
  ledger_.hold(tag);
  posting_->changed.notify();
  while (posting_->down.bytes_inside() > posting_->settings.buffer_bytes) wait(posting_->changed);
  ledger_.extend(tag, Part::bus, Phase::posting, began, now_ps());
  // The target is looked up later; a processor never learns of a posted write's master abort.
  transaction.set_response_status(tlm::TLM_OK_RESPONSE);
}

void PciBus::drain_to_targets() {
  while (true) {
    while (posting_->down.empty()) wait(posting_->changed);
    PostedWrite& write = posting_->down.front();
    const auto bytes = static_cast<std::int64_t>(write.data.size());
    const Service service{kProcessor,  link::Direction::write, bytes, 0,
                          write.phase, write.tag.frame};
    occupy(service, beyond_buffer(bytes, posting_->settings.buffer_bytes, model_.burst_bytes));
    account(write.tag, write.phase, write.began,
            alone(service) + (untimed_ ? 0 : way_to_bus(link::Direction::write)));
    const Tag held = write.tag;
    reach_target(posting_->to_target.of(write));
    ledger_.unhold(held);
    posting_->down.pop();
    posting_->changed.notify();
  }
}

// The rest of the block that is on the bus fits into the buffer.
void PciBus::first_has_left() {
  PostedWrite& write = posting_->down.front();
  write.inside = std::min<std::int64_t>(write.inside, posting_->settings.buffer_bytes);
  posting_->changed.notify();
}

void PciBus::post_to_memory(tlm::tlm_generic_payload& transaction, const Tag& tag) {
  while (posting_->up.full()) wait(posting_->changed);
  PostedWrite& write = posting_->up.push(transaction.get_address(), transaction.get_data_ptr(),
                                         transaction.get_data_length());
  write.tag = tag;
  write.began = now_ps();
  write.due = now_ps() + (untimed_ ? 0 : posting_->settings.to_memory());
  ledger_.hold(tag);
  posting_->changed.notify();
  transaction.set_response_status(tlm::TLM_OK_RESPONSE);
}

void PciBus::drain_to_memory() {
  while (true) {
    while (posting_->up.empty()) wait(posting_->changed);
    PostedWrite& write = posting_->up.front();
    if (write.due > now_ps()) wait(to_sc_time(write.due - now_ps()));
    const Tag held = write.tag;
    ledger_.extend(write.tag, Part::bus, Phase::to_memory, write.began, now_ps());
    reach_memory(posting_->to_memory.of(write));
    ledger_.unhold(held);
    posting_->up.pop();
    posting_->changed.notify();
  }
}

// Waits for the writes that are queued now, and for those posted behind them in the meantime.
void PciBus::wait_for_posted(PostedWrites Posting::*writes) {
  while (!((*posting_).*writes).empty()) wait(posting_->changed);
}

void PciBus::drain_to_board() {
  if (posting_) wait_for_posted(&Posting::down);
}

void PciBus::drain_to_host() {
  if (posting_) wait_for_posted(&Posting::up);
}

}  // namespace hvp::vp
