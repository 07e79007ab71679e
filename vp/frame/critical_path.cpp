#include "vp/frame/critical_path.h"

#include <algorithm>
#include <stdexcept>
#include <string>

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

}  // namespace hvp::vp
