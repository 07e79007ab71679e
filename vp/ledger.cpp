#include "vp/ledger.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace hvp::vp {

namespace {
// A frame of today's host has about 40 spans.
constexpr std::size_t kSpansReserved = 256;

[[noreturn]] void broken(const Frame& frame, const std::string& what) {
  throw std::logic_error("frame " + std::to_string(frame.number) + ": " + what);
}
}  // namespace

void critical_path(const Frame& frame, std::vector<SpanId>& path) {
  path.clear();
  if (frame.force_at_motor == kBirth) broken(frame, "no force reached the motor");
  for (SpanId id = frame.force_at_motor; id != kBirth;) {
    if (id < 0 || static_cast<std::size_t>(id) >= frame.spans.size()) {
      broken(frame, "a span names a cause that is not in the ledger");
    }
    const Span& span = frame.spans[static_cast<std::size_t>(id)];
    path.push_back(id);
    if (path.size() > frame.spans.size()) broken(frame, "the causes go round in a circle");
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
  std::reverse(path.begin(), path.end());
}

std::vector<SpanId> critical_path(const Frame& frame) {
  std::vector<SpanId> path;
  critical_path(frame, path);
  return path;
}

void Ledger::take(const Tenure& tenure) const {
  if (tenure.end == tenure.start) return;
  for (TenureSink* sink : tenure_sinks_) sink->take(tenure);
}

Frame& Ledger::open(std::int64_t number, Picoseconds born) {
  if (spare_.empty()) {
    spare_.emplace_back();
    spare_.back().spans.reserve(kSpansReserved);
  }
  Frame frame = std::move(spare_.back());
  spare_.pop_back();
  std::vector<Span> spans = std::move(frame.spans);
  spans.clear();
  frame = Frame{};
  frame.spans = std::move(spans);
  frame.number = number;
  frame.born = born;
  open_.push_back({std::move(frame)});
  return open_.back().frame;
}

Ledger::Entry& Ledger::entry(std::int64_t number) {
  const auto hit = std::find_if(open_.begin(), open_.end(),
                                [number](const Entry& e) { return e.frame.number == number; });
  if (hit == open_.end()) {
    throw std::logic_error("frame " + std::to_string(number) + " is not open");
  }
  return *hit;
}

bool Ledger::has(std::int64_t number) const {
  return std::any_of(open_.begin(), open_.end(),
                     [number](const Entry& e) { return e.frame.number == number; });
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
  for (const Entry& e : open_) {
    if (e.closed) broken(e.frame, "the run ended while something of it was under way");
  }
}

void Ledger::hand_on_ready() {
  auto ready = open_.begin();
  for (; ready != open_.end() && ready->closed && ready->holds == 0; ++ready) {
    hand_on(ready->frame);
    spare_.push_back(std::move(ready->frame));
  }
  open_.erase(open_.begin(), ready);
}

void Ledger::hand_on(const Frame& frame) {
  critical_path(frame, path_);
  for (FrameSink* sink : sinks_) sink->take(frame, path_);
}

}  // namespace hvp::vp
