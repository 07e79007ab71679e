#include "vp/pci/pci_bus.h"

#include <algorithm>

#include "vp/bus/bus_transaction.h"

namespace hvp::vp {

namespace {

using link::Direction;

constexpr std::size_t kPlacesToMemory = 64;

Direction direction_of(const tlm::tlm_generic_payload& transaction) {
  return transaction.is_read() ? Direction::read : Direction::write;
}

}  // namespace

PciBus::PciBus(const sc_core::sc_module_name& name, const link::Pci& model, bool untimed,
               Ledger& ledger)
    : sc_module(name),
      from_host("from_host"),
      from_board("from_board"),
      model_(model),
      untimed_(untimed),
      ledger_(ledger),
      to_targets_("to_targets"),
      to_memory_("to_memory") {
  from_host.register_b_transport(this, &PciBus::from_host_transport);
  from_board.register_b_transport(this, &PciBus::from_board_transport);
  use(kProcessor).name = "processor";
  use(kTraffic).name = "traffic";
  use(kBoard).name = "board";
  use(kGraphics).name = "graphics";
}

PciBus::PciBus(const sc_core::sc_module_name& name, const BusSettings& settings, Timing level,
               Ledger& ledger, std::int64_t seed)
    : PciBus(name, settings.pci, level == Timing::untimed, ledger) {
  if (settings.read_latencies) {
    reads_.emplace(*settings.read_latencies, seed, "bus.read_latencies");
  }
  if (settings.posted_writes) {
    posting_ = std::make_unique<Posting>(*settings.posted_writes, kPlacesToMemory);
    SC_HAS_PROCESS(PciBus);
    SC_THREAD(drain_to_targets);
    set_stack_size(kTargetsStackBytes);
    SC_THREAD(drain_to_memory);
    set_stack_size(kTargetsStackBytes);
  }
  if (level != Timing::approximately_timed) return;
  arbiter_ = std::make_unique<link::PciArbiter>(
      settings.pci, settings.protocol.value_or(link::PciProtocol{}), kMasters);
  arbiter_->report_to(*this);
}

void PciBus::attach(tlm::tlm_target_socket<>& target, std::uint64_t base, std::uint64_t size) {
  to_targets_.bind(target);
  windows_.push_back({base, size, static_cast<int>(windows_.size())});
}

void PciBus::attach_memory(tlm::tlm_target_socket<>& memory) {
  to_memory_.bind(memory);
  has_memory_ = true;
}

PciBus::Window* PciBus::claim(std::uint64_t address) {
  const auto hit = std::find_if(windows_.begin(), windows_.end(), [address](const Window& w) {
    return address >= w.base && address - w.base < w.size;
  });
  return hit == windows_.end() ? nullptr : &*hit;
}

void PciBus::from_host_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
  wait(delay);
  delay = sc_core::SC_ZERO_TIME;
  if (posting_ && transaction.is_write()) {
    post(transaction);
    return;
  }
  Tag none;
  Tag& tag = tag_of(transaction, none);
  const Direction direction = direction_of(transaction);
  const std::int64_t bytes = bytes_of(transaction);
  const Service service{
      kProcessor, direction, bytes, way_to_bus(transaction), processors_phase(transaction),
      tag.frame};
  const Picoseconds began = now_ps();
  if (posting_) wait_for_posted(&Posting::down);
  occupy(service);
  account(tag, service.phase, began, alone(service));
  reach_target(transaction);
  if (!posting_) return;
  // The answer pushes what the board has written before it ahead of itself.
  const Picoseconds answered = now_ps();
  wait_for_posted(&Posting::up);
  if (now_ps() > answered) ledger_.extend(tag, Part::bus, Phase::to_memory, answered, now_ps());
}

void PciBus::reach_target(tlm::tlm_generic_payload& transaction) {
  const std::uint64_t address = transaction.get_address();
  const Window* window = claim(address);
  if (window == nullptr) {
    master_abort(transaction);
    return;
  }
  sc_core::sc_time held;
  transaction.set_address(address - window->base);
  to_targets_[window->target]->b_transport(transaction, held);
  transaction.set_address(address);
  keep_bus(kProcessor, static_cast<Picoseconds>(held.value()));
}

void PciBus::from_board_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
  wait(delay);
  delay = sc_core::SC_ZERO_TIME;
  Tag none;
  Tag& tag = tag_of(transaction, none);
  const Service service{kBoard, direction_of(transaction), bytes_of(transaction),
                        0,      boards_phase(transaction), tag.frame};
  const Picoseconds began = now_ps();
  if (posting_ && transaction.is_read()) wait_for_posted(&Posting::up);
  occupy(service);
  account(tag, service.phase, began, alone(service));
  if (posting_ && transaction.is_write()) {
    post_to_memory(transaction, tag);
  } else {
    reach_memory(transaction);
  }
}

void PciBus::reach_memory(tlm::tlm_generic_payload& transaction) {
  if (!has_memory_) {
    master_abort(transaction);
    return;
  }
  sc_core::sc_time held;
  to_memory_->b_transport(transaction, held);
  keep_bus(kBoard, static_cast<Picoseconds>(held.value()));
}

Picoseconds PciBus::way_to_bus(Direction direction) const {
  return direction == Direction::read ? model_.read_ps(0) : model_.write_ps(0);
}

Picoseconds PciBus::way_to_bus(tlm::tlm_generic_payload& transaction) {
  const std::int64_t frame = frame_of(transaction);
  if (reads_ && transaction.is_read() && frame >= 0) return reads_->next(frame);
  return way_to_bus(direction_of(transaction));
}

Picoseconds PciBus::alone(const Service& service) const {
  if (untimed_) return 0;
  if (arbiter_) {
    return service.latency + arbiter_->clocks().alone_ps(service.direction, service.bytes);
  }
  const bool read = service.direction == Direction::read;
  return service.latency +
         (read ? model_.read_wire_ps(service.bytes) : model_.write_wire_ps(service.bytes));
}

// Returns when the bus is released. Where `first` is not zero, first_has_left() is called when so
// many bytes are.
void PciBus::occupy(const Service& service, std::int64_t first) {
  if (arbiter_) {
    occupy_in_bursts(service, first);
  } else {
    occupy_whole(service, first);
  }
  use(service.master).bytes += service.bytes;
  ++use(service.master).transactions;
}

// Among masters that ask or wait at the same instant the one with the lowest number is served
// first, whatever the kernel runs first: all have asked when a delta cycle is over.
void PciBus::take_turn(Master master) {
  int& asking = asking_[static_cast<std::size_t>(master)];
  const auto lower = asking_.begin() + static_cast<int>(master);
  ++asking;
  do {
    while (free_at_ > now_ps()) wait(to_sc_time(free_at_ - now_ps()));
    if (has_memory_) wait(sc_core::SC_ZERO_TIME);
  } while (free_at_ > now_ps() ||
           std::any_of(asking_.begin(), lower, [](int others) { return others > 0; }));
  --asking;
}

void PciBus::occupy_whole(const Service& service, std::int64_t first) {
  take_turn(service.master);
  const Picoseconds time = alone(service);
  free_at_ = now_ps() + time;
  use(service.master).busy += time;
  last_user_ = service.master;
  errands_[static_cast<std::size_t>(service.master)] = {service.phase, service.frame};
  owned(service.master, now_ps(), free_at_);
  Picoseconds before = 0;
  if (first > 0) {
    before = untimed_ ? 0 : service.latency + model_.write_wire_ps(first);
    wait(to_sc_time(before));
    first_has_left();
  }
  wait(to_sc_time(time - before));
}

void PciBus::occupy_in_bursts(const Service& service, std::int64_t first) {
  bool& served = served_[static_cast<std::size_t>(service.master)];
  while (served) wait(changed_);
  served = true;
  errands_[static_cast<std::size_t>(service.master)] = {service.phase, service.frame};
  wait(to_sc_time(service.latency));
  if (first > 0) {
    request_and_wait(service.master, service.direction, first);
    first_has_left();
  }
  if (first < service.bytes) {
    request_and_wait(service.master, service.direction, service.bytes - first);
  }
  served = false;
  changed_.notify();
}

void PciBus::request_and_wait(Master master, Direction direction, std::int64_t bytes) {
  arbiter_->request(master, direction, bytes, now_ps());
  changed_.notify();
  while (!arbiter_->done(master)) {
    wait(to_sc_time(arbiter_->forecast(master) - now_ps()), changed_);
    arbiter_->advance(now_ps());
  }
}

// To or from the host's memory.
void PciBus::move(Master master, Direction direction, std::int64_t bytes) {
  errands_[static_cast<std::size_t>(master)].phase =
      direction == Direction::read ? Phase::dma_read : Phase::dma_write;
  request_and_wait(master, direction, bytes);
  use(master).bytes += bytes;
  ++use(master).transactions;
}

// Waiting for the clock's edge and for others is spread over the bursts; the ledger has all of it
// in one span, before that of the transaction. A retried read can end sooner than it would alone:
// what another master moves in the meantime shifts its attempts to where the target is just ready.
void PciBus::account(Tag& tag, Phase phase, Picoseconds began, Picoseconds alone) {
  const Picoseconds waited = std::max<Picoseconds>(0, now_ps() - began - alone);
  if (waited > 0) ledger_.extend(tag, Part::bus, Phase::arbitration, began, began + waited);
  ledger_.extend(tag, Part::bus, phase, began + waited, now_ps());
}

// Wait states that a target adds, with the bus.
void PciBus::keep_bus(Master master, Picoseconds time) {
  if (time == 0) return;
  if (arbiter_) {
    const Picoseconds before = arbiter_->held_ps();
    arbiter_->hold(master, now_ps() + time);
    use(master).busy += arbiter_->held_ps() - before;
    changed_.notify();
  } else {
    free_at_ = now_ps() + time;
    use(master).busy += time;
    last_user_ = master;
    owned(master, now_ps(), free_at_);
  }
  wait(to_sc_time(time));
}

void PciBus::owned(int master, Picoseconds start, Picoseconds end) {
  if (!ledger_.takes_tenures()) return;
  const auto who = static_cast<std::size_t>(master);
  ledger_.take({Resource::bus, uses_[who].name, vp::name(errands_[who].phase), errands_[who].frame,
                start, end});
}

BusUses PciBus::uses() const {
  BusUses uses(uses_.begin(), uses_.end());
  if (!arbiter_) return uses;
  for (int master = 0; master < kMasters; ++master) {
    uses[static_cast<std::size_t>(master)].busy += arbiter_->statistics(master).owned_ps;
  }
  return uses;
}

Picoseconds PciBus::busy() const {
  Picoseconds sum = 0;
  for (const BusUse& use : uses_) sum += use.busy;
  if (!arbiter_) return sum;
  for (int master = 0; master < kMasters; ++master) sum += arbiter_->statistics(master).owned_ps;
  return sum;
}

BusUses PciBus::uses_until_now() const {
  BusUses uses(uses_.begin(), uses_.end());
  if (!arbiter_) {
    uses[static_cast<std::size_t>(last_user_)].busy -=
        std::max<Picoseconds>(0, free_at_ - now_ps());
    return uses;
  }
  for (int master = 0; master < kMasters; ++master) {
    uses[static_cast<std::size_t>(master)].busy += arbiter_->owned_ps(master, now_ps());
  }
  return uses;
}

Picoseconds PciBus::busy_until_now() const {
  if (arbiter_) return arbiter_->taken_ps(now_ps());
  return busy() - std::max<Picoseconds>(0, free_at_ - now_ps());
}

}  // namespace hvp::vp
