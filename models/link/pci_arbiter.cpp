#include "models/link/pci_arbiter.h"

#include <algorithm>
#include <string>

#include "models/config/input_error.h"

namespace hvp::link {

PciArbiter::PciArbiter(const Pci& bus, const PciProtocol& protocol, int masters)
    : clocks_(bus, protocol), count_(masters) {
  if (masters < 1 || masters > kMaxMasters) {
    throw InputError("a PCI bus of " + std::to_string(masters) + " masters; 1 to " +
                     std::to_string(kMaxMasters) + " are possible");
  }
}

std::int64_t PciArbiter::clock_of(std::int64_t time_ps) const {
  return (time_ps + clocks_.period_ps() - 1) / clocks_.period_ps();
}

void PciArbiter::request(int master, Direction direction, std::int64_t bytes,
                         std::int64_t time_ps) {
  advance(time_ps);
  Master& m = at(master);
  m.busy = true;
  m.releasing = false;
  m.direction = direction;
  m.left = clocks_.phases(bytes);
  m.moved = 0;
  m.bytes = bytes;
  m.fetching = false;
  m.fetched = false;
  m.requested = clock_of(time_ps);
}

void PciArbiter::hold(int master, std::int64_t until_ps) {
  const std::int64_t until = clock_of(until_ps);
  if (until <= free_) return;
  held_ += until - free_;
  report(master, free_, until);
  free_ = until;
  last_user_ = master;
}

void PciArbiter::advance(std::int64_t time_ps) { run(time_ps / clocks_.period_ps()); }

// Everything at clocks up to `to`, but for grants at `to` itself: another master may still request
// at that very instant.
void PciArbiter::run(std::int64_t to) {
  while (true) {
    release(to);
    if (owner_ < 0) {
      const std::int64_t grant = next_grant();
      if (grant >= to) return;
      begin_tenure(grant);
    }
    const std::int64_t phases = tenure_phases();
    if (tenure_end(phases) > to) return;
    end_tenure(phases);
  }
}

std::int64_t PciArbiter::next_grant() const {
  std::int64_t first = kNever;
  for (int i = 0; i < count_; ++i) {
    if (competes(i)) first = std::min(first, at(i).requested + clocks_.arbitration());
  }
  return first == kNever ? kNever : std::max(first, free_);
}

// The winner among the masters whose request the arbiter has seen by this clock.
int PciArbiter::winner(std::int64_t clock) const {
  const bool fixed = clocks_.protocol().arbitration == PciArbitration::fixed_priority;
  for (int step = 0; step < count_; ++step) {
    const int candidate = fixed ? step : (last_owner_ + 1 + step) % count_;
    if (competes(candidate) && at(candidate).requested + clocks_.arbitration() <= clock) {
      return candidate;
    }
  }
  return -1;
}

bool PciArbiter::attempt_in_vain(const Master& m, std::int64_t clock) const {
  if (!clocks_.delays(m.direction) || m.fetched) return false;
  return !m.fetching || clock + clocks_.address() < m.ready;
}

void PciArbiter::begin_tenure(std::int64_t clock) {
  owner_ = winner(clock);
  last_owner_ = owner_;
  last_user_ = owner_;
  address_ = clock;
  Master& m = at(owner_);
  m.statistics.waiting_ps += (clock - m.requested) * clocks_.period_ps();
  ++m.statistics.tenures;
  retrying_ = attempt_in_vain(m, clock);
  if (retrying_ && !m.fetching) {
    m.fetching = true;
    m.ready = clock + clocks_.address() + clocks_.protocol().delayed_read_clocks;
  }
  if (!retrying_) m.fetched = true;
  const std::int64_t boundary = clocks_.burst_phases() - m.moved % clocks_.burst_phases();
  planned_ = retrying_ ? 0 : std::min(m.left, boundary);
}

// The edge at which GNT# is gone, because the arbiter has another master to serve.
std::int64_t PciArbiter::preempted_at() const {
  const bool fixed = clocks_.protocol().arbitration == PciArbitration::fixed_priority;
  std::int64_t first = kNever;
  for (int i = 0; i < (fixed ? owner_ : count_); ++i) {
    if (i == owner_ || !competes(i)) continue;
    first = std::min(first, at(i).requested + clocks_.arbitration());
  }
  return first;
}

std::int64_t PciArbiter::tenure_phases() const {
  const std::int64_t gone = preempted_at();
  if (retrying_ || gone == kNever) return planned_;
  const Master& m = at(owner_);
  const std::int64_t cut = std::max(gone, address_ + clocks_.protocol().latency_timer_clocks);
  const std::int64_t first = address_ + clocks_.address() + clocks_.first_wait(m.direction);
  // The first data phase that ends after the edge is the last one.
  std::int64_t phases = cut < first ? 1 : (cut - first) / clocks_.per_phase() + 1;
  const std::int64_t boundary = clocks_.disconnect_phases();
  const std::int64_t offset = m.moved % boundary;
  phases = (offset + phases + boundary - 1) / boundary * boundary - offset;
  return std::min(phases, planned_);
}

std::int64_t PciArbiter::tenure_end(std::int64_t phases) const {
  return address_ + clocks_.address() + clocks_.first_wait(at(owner_).direction) +
         phases * clocks_.per_phase();
}

void PciArbiter::end_tenure(std::int64_t phases) {
  Master& m = at(owner_);
  free_ = tenure_end(phases) + clocks_.turnaround();
  m.statistics.owned_ps += (free_ - address_) * clocks_.period_ps();
  report(owner_, address_, free_);
  m.moved += phases;
  m.left -= phases;
  m.requested = free_;
  if (retrying_) {
    ++m.statistics.retries;
    m.requested =
        clocks_.splits() ? std::max(free_, m.ready) : free_ + clocks_.protocol().retry_gap_clocks;
  } else if (phases < planned_) {
    ++m.statistics.preemptions;
  } else if (m.left == 0) {
    m.releasing = true;
    m.completed = free_;
    m.statistics.bytes += m.bytes;
  } else {
    m.fetching = false;
    m.fetched = false;
  }
  owner_ = -1;
}

void PciArbiter::report(int master, std::int64_t start, std::int64_t end) const {
  if (observer_ == nullptr) return;
  observer_->owned(master, start * clocks_.period_ps(), end * clocks_.period_ps());
}

void PciArbiter::release(std::int64_t clock) {
  for (int i = 0; i < count_; ++i) {
    Master& m = at(i);
    if (m.releasing && m.completed <= clock) {
      m.releasing = false;
      m.busy = false;
    }
  }
}

std::int64_t PciArbiter::taken_ps(std::int64_t until_ps) const {
  const PciArbiter then = followed(until_ps);
  std::int64_t taken = then.held_ps();
  for (int i = 0; i < count_; ++i) taken += then.owned_before(i, until_ps);
  return taken;
}

std::int64_t PciArbiter::owned_ps(int master, std::int64_t until_ps) const {
  return followed(until_ps).owned_before(master, until_ps);
}

// A copy that nobody observes, up to the clock under way: a grant there has been decided.
PciArbiter PciArbiter::followed(std::int64_t until_ps) const {
  PciArbiter then = *this;
  then.observer_ = nullptr;
  then.run(clock_of(until_ps));
  return then;
}

std::int64_t PciArbiter::owned_before(int master, std::int64_t until_ps) const {
  const std::int64_t owned = at(master).statistics.owned_ps;
  if (owner_ == master) return owned + until_ps - address_ * clocks_.period_ps();
  if (owner_ >= 0 || last_user_ != master) return owned;
  return owned - std::max<std::int64_t>(0, free_ * clocks_.period_ps() - until_ps);
}

std::int64_t PciArbiter::forecast(int master) const {
  if (!busy(master)) return kNever;
  PciArbiter ahead = *this;
  ahead.observer_ = nullptr;
  while (!ahead.at(master).releasing) {
    if (ahead.owner_ < 0) ahead.begin_tenure(ahead.next_grant());
    ahead.end_tenure(ahead.tenure_phases());
  }
  return ahead.completed_ps(master);
}

std::int64_t PciArbiter::next_completion() const {
  std::int64_t first = kNever;
  for (int i = 0; i < count_; ++i) first = std::min(first, forecast(i));
  return first;
}

}  // namespace hvp::link
