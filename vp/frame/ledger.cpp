#include "vp/frame/ledger.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace hvp::vp {

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

}  // namespace hvp::vp
