#include "vp/pcie/pcie_bus.h"

#include <algorithm>

#include "models/time/picoseconds.h"
#include "vp/bus/bus_transaction.h"

namespace hvp::vp {

namespace {

constexpr std::int64_t kWordBytes = 4;
// A message's meaning, in place of an address.
constexpr std::uint64_t kAssert = 1;
constexpr std::uint64_t kDeassert = 0;

}  // namespace

PcieBus::PcieBus(const sc_core::sc_module_name& name, const link::Pcie& link, Timing level,
                 Ledger& ledger)
    : sc_module(name),
      from_host("from_host"),
      from_board("from_board"),
      interrupt_line("interrupt_line"),
      link_(link),
      formulas_(link),
      untimed_(level == Timing::untimed),
      to_port_(untimed_ ? 0 : to_picoseconds(link.processor_latency_s / 2)),
      from_port_(untimed_ ? 0 : to_picoseconds(link.processor_latency_s) - to_port_),
      ledger_(ledger),
      timing_(link, level, ledger),
      down_(
          "down", timing_, PcieTiming::kProcessorWrites, link.write_combining_bytes,
          untimed_ ? 0 : to_picoseconds(link.write_gap_s), ledger, [](PostedWrite&) {},
          [this](PostedWrite& write) { arrived_at_board(write); }),
      up_(
          "up", timing_, PcieTiming::kBoardWrites, 0, 0, ledger,
          [this](PostedWrite& write) { has_left(write); },
          [this](PostedWrite& write) { arrived_at_host(write); }),
      to_targets_("to_targets"),
      to_memory_("to_memory") {
  from_host.register_b_transport(this, &PcieBus::from_host_transport);
  from_board.register_b_transport(this, &PcieBus::from_board_transport);
  uses_[kProcessor].name = "processor";
  uses_[kBoard].name = "board";
}

PcieBus::PcieBus(const sc_core::sc_module_name& name, const PcieSettings& settings, Timing level,
                 Ledger& ledger, std::int64_t seed)
    : PcieBus(name, settings, level, ledger) {
  if (settings.root_complex_latencies) {
    root_complex_.emplace(*settings.root_complex_latencies, seed);
  }
}

void PcieBus::attach(tlm::tlm_target_socket<>& target, std::uint64_t base, std::uint64_t size) {
  to_targets_.bind(target);
  windows_.push_back({base, size, static_cast<int>(windows_.size())});
}

void PcieBus::attach_memory(tlm::tlm_target_socket<>& memory) {
  to_memory_.bind(memory);
  has_memory_ = true;
}

void PcieBus::from_host_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
  wait(delay);
  delay = sc_core::SC_ZERO_TIME;
  if (transaction.is_write()) {
    processor_write(transaction);
  } else {
    processor_read(transaction);
  }
}

void PcieBus::from_board_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
  wait(delay);
  delay = sc_core::SC_ZERO_TIME;
  if (transaction.is_write()) {
    board_write(transaction);
  } else {
    board_read(transaction);
  }
}

const link::Cost& PcieBus::processor_write_cost(std::int64_t bytes) {
  return write_cost_.of(bytes,
                        [this](std::int64_t n) { return formulas_.processor_write(n, true); });
}

const link::Cost& PcieBus::processor_read_cost(std::int64_t bytes) {
  return read_cost_.of(bytes, [this](std::int64_t n) { return formulas_.processor_read(n); });
}

void PcieBus::processor_write(tlm::tlm_generic_payload& transaction) {
  Tag none;
  Tag& tag = tag_of(transaction, none);
  const std::int64_t bytes = bytes_of(transaction);
  const link::Cost cost = processor_write_cost(bytes);
  const Picoseconds began = now_ps();
  PostedWrite& write = down_.post(transaction, tag);
  write.phase = processors_phase(transaction);
  write.began = began;
  write.due = now_ps() + to_port_;
  count(kProcessor, cost, bytes);
  wait(to_sc_time(untimed_ ? 0 : cost.processor_ps));
  ledger_.extend(tag, Part::bus, Phase::posting, began, now_ps());
  transaction.set_response_status(tlm::TLM_OK_RESPONSE);
}

void PcieBus::arrived_at_board(PostedWrite& write) {
  const auto bytes = static_cast<std::int64_t>(write.data.size());
  account(write.tag, write.phase, write.began, processor_write_cost(bytes).latency_ps);
  reach_target(to_target_.of(write));
}

// A word after the other; the target is read once, when the last word's request is there.
void PcieBus::processor_read(tlm::tlm_generic_payload& transaction) {
  Tag none;
  Tag& tag = tag_of(transaction, none);
  const Picoseconds began = now_ps();
  while (processor_reads_) wait(read_over_);
  processor_reads_ = true;
  const std::int64_t bytes = bytes_of(transaction);
  std::int64_t behind = 0;
  for (std::int64_t word = 0; word < bytes; word += kWordBytes) {
    wait(to_sc_time(to_port_));
    const std::int64_t ahead = down_.posted();
    down_.wait_until_left(ahead);
    timing_.ask(PcieTiming::kProcessorReads, kWordBytes,
                {processors_phase(transaction), tag.frame});
    if (word + kWordBytes >= bytes) {
      down_.wait_until_delivered(ahead);
      reach_target(transaction);
      behind = up_.posted();
    }
    timing_.await_answer(PcieTiming::kProcessorReads);
    if (word + kWordBytes < bytes) wait(to_sc_time(from_port_));
  }
  processor_reads_ = false;
  read_over_.notify();
  up_.wait_until_delivered(behind);
  wait(to_sc_time(from_port_));
  const link::Cost& cost = processor_read_cost(bytes);
  count(kProcessor, cost, bytes);
  account(tag, processors_phase(transaction), began, cost.latency_ps);
}

void PcieBus::board_write(tlm::tlm_generic_payload& transaction) {
  Tag none;
  Tag& tag = tag_of(transaction, none);
  const Picoseconds began = now_ps();
  PostedWrite& write = up_.post(transaction, tag);
  write.phase = boards_phase(transaction);
  write.began = began;
  write.sender = &tag;
  count(kBoard, formulas_.dma_write(bytes_of(transaction)), bytes_of(transaction));
  up_.wait_until_left(up_.posted());
  transaction.set_response_status(tlm::TLM_OK_RESPONSE);
}

// The time of sending is the board's; the way through the link and to memory is the data's.
void PcieBus::has_left(PostedWrite& write) {
  if (write.sender == nullptr) return;
  const auto bytes = static_cast<std::int64_t>(write.data.size());
  account(write.tag, write.phase, write.began,
          formulas_.dma_write(bytes).latency_ps - link_.link_ps());
  *write.sender = write.tag;
  write.began = now_ps();
}

void PcieBus::arrived_at_host(PostedWrite& write) {
  if (!write.data.empty()) {
    ledger_.extend(write.tag, Part::bus, Phase::to_memory, write.began, now_ps());
    reach_memory(to_host_.of(write));
    return;
  }
  account(write.tag, Phase::message, write.began,
          formulas_.interrupt(link::Interrupt::intx).latency_ps);
  if (interrupt_line.size() == 0) return;
  if (write.address == kAssert) {
    interrupt_line->interrupt(write.tag);
  } else {
    interrupt_line->lowered();
  }
}

void PcieBus::board_read(tlm::tlm_generic_payload& transaction) {
  Tag none;
  Tag& tag = tag_of(transaction, none);
  const Picoseconds began = now_ps();
  while (board_reads_) wait(read_over_);
  board_reads_ = true;
  const std::int64_t bytes = bytes_of(transaction);
  const std::int64_t ahead = up_.posted();
  up_.wait_until_left(ahead);
  const link::CompleterTimes* const times = root_complex_times(tag.frame, bytes);
  timing_.ask(PcieTiming::kBoardReads, bytes, {boards_phase(transaction), tag.frame}, times);
  up_.wait_until_delivered(ahead);
  reach_memory(transaction);
  timing_.await_answer(PcieTiming::kBoardReads);
  const Picoseconds alone = times == nullptr ? link_.read_ps(link::PcieSide::device, bytes)
                                             : link_.read_ps(link::PcieSide::device, bytes, *times);
  board_reads_ = false;
  read_over_.notify();
  count(kBoard, formulas_.dma_read(bytes), bytes);
  account(tag, boards_phase(transaction), began, alone);
}

const link::CompleterTimes* PcieBus::root_complex_times(std::int64_t frame, std::int64_t bytes) {
  if (!root_complex_ || frame < 0) return nullptr;
  root_complex_->frame = frame;
  root_complex_->first = root_complex_->draws.take(frame, link_.requests(bytes));
  return &*root_complex_;
}

void PcieBus::interrupt(const Tag& tag) { up_.post_message(kAssert, tag); }
void PcieBus::lowered() { up_.post_message(kDeassert, Tag{}); }

void PcieBus::reach_target(tlm::tlm_generic_payload& transaction) {
  const std::uint64_t address = transaction.get_address();
  const auto hit = std::find_if(windows_.begin(), windows_.end(), [address](const Window& w) {
    return address >= w.base && address - w.base < w.size;
  });
  if (hit == windows_.end()) {
    master_abort(transaction);
    return;
  }
  sc_core::sc_time held;
  transaction.set_address(address - hit->base);
  to_targets_[hit->target]->b_transport(transaction, held);
  transaction.set_address(address);
  if (held != sc_core::SC_ZERO_TIME) wait(held);
}

void PcieBus::reach_memory(tlm::tlm_generic_payload& transaction) {
  if (!has_memory_) {
    master_abort(transaction);
    return;
  }
  sc_core::sc_time held;
  to_memory_->b_transport(transaction, held);
  if (held != sc_core::SC_ZERO_TIME) wait(held);
}

// The time beyond that on an unloaded link is waiting: for others, and for the link layer's
// packets.
void PcieBus::account(Tag& tag, Phase phase, Picoseconds began, Picoseconds alone) {
  const Picoseconds waited = untimed_ ? 0 : std::max<Picoseconds>(0, now_ps() - began - alone);
  if (waited > 0) ledger_.extend(tag, Part::bus, Phase::arbitration, began, began + waited);
  ledger_.extend(tag, Part::bus, phase, began + waited, now_ps());
}

void PcieBus::count(User user, const link::Cost& cost, std::int64_t bytes) {
  BusUse& use = uses_[user];
  if (!untimed_) use.busy += cost.bus_ps;
  use.bytes += bytes;
  ++use.transactions;
}

void PcieBus::drain_to_board() { down_.wait_until_delivered(down_.posted()); }

void PcieBus::drain_to_host() { up_.wait_until_delivered(up_.posted()); }

HostBridge::HostBridge(const sc_core::sc_module_name& name, std::uint64_t link_base,
                       std::uint64_t link_size)
    : sc_module(name),
      from_host("from_host"),
      to_link("to_link"),
      to_bus("to_bus"),
      link_base_(link_base),
      link_size_(link_size) {
  from_host.register_b_transport(this, &HostBridge::b_transport);
}

void HostBridge::b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
  const std::uint64_t address = transaction.get_address();
  if (address >= link_base_ && address - link_base_ < link_size_) {
    to_link->b_transport(transaction, delay);
  } else {
    to_bus->b_transport(transaction, delay);
  }
}

}  // namespace hvp::vp
