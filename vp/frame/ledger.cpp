#include "vp/frame/ledger.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace hvp::vp {

void CriticalPath::follow(const Frame& frame) {
  spans_.clear();
  attribution_.clear();
  index_.fill(0);
  parts_.fill(0);
  if (frame.force_at_motor == kBirth) broken(frame, "no force reached the motor");
  for (SpanId id = frame.force_at_motor; id != kBirth;) {
    if (id < 0 || static_cast<std::size_t>(id) >= frame.spans.size()) {
      broken(frame, "a span names a cause that is not in the ledger");
    }
    const Span& span = frame.spans[static_cast<std::size_t>(id)];
    spans_.push_back(id);
    if (spans_.size() > frame.spans.size()) broken(frame, "the causes go round in a circle");
    const Picoseconds before = span.cause == kBirth
                                   ? frame.born
                                   : frame.spans.at(static_cast<std::size_t>(span.cause)).end;
    if (span.start != before || span.end < span.start) {
      broken(frame, "span " + std::string(name(span.part)) + "/" + std::string(name(span.phase)) +
                        " starts at " + std::to_string(span.start) + " ps, its cause ends at " +
                        std::to_string(before) + " ps");
    }
    id = span.cause;
  }
  std::reverse(spans_.begin(), spans_.end());
  for (const SpanId id : spans_) add(frame.spans[static_cast<std::size_t>(id)]);
}

void CriticalPath::add(const Span& span) {
  const auto part = static_cast<std::size_t>(span.part);
  std::uint16_t& index = index_.at(part * kPhases + static_cast<std::size_t>(span.phase));
  if (index == 0) {
    attribution_.push_back({span.part, span.phase, 0});
    index = static_cast<std::uint16_t>(attribution_.size());
  }
  attribution_[index - std::size_t{1}].time += span.end - span.start;
  parts_[part] += span.end - span.start;
}

Picoseconds CriticalPath::time(Phase phase) const {
  Picoseconds time = 0;
  for (const Attribution& a : attribution_) {
    if (a.phase == phase) time += a.time;
  }
  return time;
}

namespace {
// A frame of today's host has about 40 spans.
constexpr std::size_t kSpansReserved = 256;
}  // namespace

void Ledger::take(const Tenure& tenure) const {
  if (tenure.end == tenure.start) return;
  for (TenureSink* sink : tenure_sinks_) sink->take(tenure);
}

void Ledger::begin() {
  for (FrameObserver* observer : observers_) observer->begun();
}

Frame& Ledger::open(std::int64_t number, Picoseconds born) {
  if (spare_.empty()) {
    spare_.push_back(std::make_unique<Entry>());
    spare_.back()->frame.spans.reserve(kSpansReserved);
  }
  std::unique_ptr<Entry> entry = std::move(spare_.back());
  spare_.pop_back();
  Frame fresh;
  fresh.number = number;
  fresh.born = born;
  // Their storage.
  fresh.spans = std::move(entry->frame.spans);
  fresh.spans.clear();
  fresh.touches = std::move(entry->frame.touches);
  fresh.touches.clear();
  fresh.ports = std::move(entry->frame.ports);
  fresh.ports.clear();
  fresh.devices = std::move(entry->frame.devices);
  fresh.devices.clear();
  *entry = {std::move(fresh)};
  open_.push_back(std::move(entry));
  return open_.back()->frame;
}

Ledger::Entry& Ledger::entry(std::int64_t number) {
  const auto hit =
      std::ranges::find_if(open_, [number](const auto& e) { return e->frame.number == number; });
  if (hit == open_.end()) {
    throw std::logic_error("frame " + std::to_string(number) + " is not open");
  }
  return **hit;
}

bool Ledger::has(std::int64_t number) const {
  return std::ranges::any_of(open_, [number](const auto& e) { return e->frame.number == number; });
}

Frame& Ledger::frame(std::int64_t number) { return entry(number).frame; }

SpanId Ledger::add(const Tag& tag, Part part, Phase phase, Picoseconds start, Picoseconds end) {
  if (tag.frame < 0) return kBirth;
  std::vector<Span>& spans = frame(tag.frame).spans;
  spans.push_back({part, phase, start, end, tag.cause});
  return static_cast<SpanId>(spans.size()) - 1;
}

void Ledger::extend(Tag& tag, Part part, Phase phase, Picoseconds start, Picoseconds end) {
  tag.cause = add(tag, part, phase, start, end);
}

Span& Ledger::span_of(const Tag& tag) {
  return frame(tag.frame).spans[static_cast<std::size_t>(tag.cause)];
}

Picoseconds Ledger::end_of(const Tag& tag) {
  return tag.cause == kBirth ? frame(tag.frame).born : span_of(tag).end;
}

void Ledger::prolong(const Tag& tag, Picoseconds end) { span_of(tag).end = end; }

void Ledger::take_back(const Tag& tag, SpanId first) {
  std::vector<Span>& spans = frame(tag.frame).spans;
  spans.erase(spans.begin() + first, spans.end());
}

void Ledger::force_at_motor(const Tag& tag) {
  if (tag.frame >= 0) frame(tag.frame).force_at_motor = tag.cause;
}

void Ledger::solved(const Frame& frame, const Solution& solution) const {
  for (FrameObserver* observer : observers_) observer->solved(frame, solution);
}

void Ledger::hold(const Tag& tag) {
  if (tag.frame < 0) return;
  ++entry(tag.frame).holds;
  ++held_;
}

void Ledger::unhold(const Tag& tag) {
  if (tag.frame < 0) return;
  Entry& held = entry(tag.frame);
  if (held.holds == 0) broken(held.frame, "nothing holds it, and it was let go");
  --held.holds;
  --held_;
}

void Ledger::close(std::int64_t number) {
  entry(number).closed = true;
  hand_on_ready();
}

void Ledger::finish() {
  hand_on_ready();
  for (const auto& e : open_) {
    if (e->closed) broken(e->frame, "the run ended while something of it was under way");
  }
}

void Ledger::hand_on_ready() {
  auto ready = open_.begin();
  for (; ready != open_.end() && (*ready)->closed && (*ready)->holds == 0; ++ready) {
    hand_on((*ready)->frame);
    spare_.push_back(std::move(*ready));
  }
  open_.erase(open_.begin(), ready);
}

void Ledger::hand_on(const Frame& frame) {
  path_.follow(frame);
  for (FrameObserver* observer : observers_) observer->closed(frame, path_);
}

std::string_view name(Resource resource) {
  switch (resource) {
    case Resource::core_0:
      return "core 0";
    case Resource::core_1:
      return "core 1";
    case Resource::bus:
      return "bus";
    case Resource::link_to_board:
      return "link to board";
    case Resource::link_to_host:
      return "link to host";
  }
  return "";
}

}  // namespace hvp::vp
