#include "vp/function/late_interrupts.h"

#include <algorithm>
#include <utility>

#include "models/time/picoseconds.h"
#include "vp/frame/frame_tag.h"

namespace hvp::vp {

LateInterrupts::LateInterrupts(const sc_core::sc_module_name& name, const host::Host& host,
                               std::int64_t seed, Ledger& ledger, Told told)
    : sc_module(name),
      latency_(to_picoseconds(host.interrupt_latency_s)),
      ledger_(ledger),
      told_(std::move(told)),
      due_("due") {
  if (host.interrupt_latencies) {
    draws_.emplace(*host.interrupt_latencies, seed, "host.interrupt_latencies");
  }
  SC_HAS_PROCESS(LateInterrupts);
  SC_METHOD(deliver);
  sensitive << due_;
  dont_initialize();
}

void LateInterrupts::raise(const Tag& tag, const Message& message) {
  const Picoseconds now = now_ps();
  Picoseconds due = now + (draws_ && tag.frame >= 0 ? draws_->next(tag.frame) : latency_);
  if (!under_way_.empty()) due = std::max(due, under_way_.back().due);
  under_way_.push_back({now, due, tag, message});
  due_.notify(to_sc_time(under_way_.front().due - now));
}

void LateInterrupts::forget_line() {
  std::erase_if(under_way_, [](const UnderWay& one) { return !one.message; });
}

void LateInterrupts::deliver() {
  while (!under_way_.empty() && under_way_.front().due <= now_ps()) {
    UnderWay one = under_way_.front();
    under_way_.pop_front();
    follow(one.tag, one.raised);
    told_(one.tag, one.message);
  }
  if (!under_way_.empty()) due_.notify(to_sc_time(under_way_.front().due - now_ps()));
}

// A host that polls may be through with the frame before its interrupt comes.
void LateInterrupts::follow(Tag& tag, Picoseconds raised) {
  if (now_ps() == raised || (tag.frame >= 0 && !ledger_.has(tag.frame))) return;
  ledger_.extend(tag, Part::host, Phase::interrupt, raised, now_ps());
}

}  // namespace hvp::vp
