#include "vp/host/word_spans.h"

#include <cstddef>
#include <vector>

namespace hvp::vp {

namespace {

bool is_word(const Span& span) {
  return span.part == Part::bus &&
         (span.phase == Phase::bus_read || span.phase == Phase::bus_write);
}

bool may_be_folded(const Span& span) {
  return is_word(span) || (span.part == Part::bus && span.phase == Phase::arbitration);
}

}  // namespace

void WordSpans::fold() {
  if (tag_.frame < 0 || tag_.cause == before_) return;
  const std::vector<Span>& spans = ledger_.frame(tag_.frame).spans;
  const auto at = [&spans](SpanId id) -> const Span& {
    return spans[static_cast<std::size_t>(id)];
  };
  // The chain back to where the block stood, as long as it is the newest of the frame's spans.
  Picoseconds waited = 0;
  SpanId first = static_cast<SpanId>(spans.size());
  for (SpanId id = tag_.cause; id != before_; id = at(id).cause) {
    if (id != first - 1 || !may_be_folded(at(id))) {
      before_ = tag_.cause;  // somebody else's stand between: the next words begin anew
      return;
    }
    if (!is_word(at(id))) waited += at(id).end - at(id).start;
    first = id;
  }
  const Span last = at(tag_.cause);
  const Picoseconds start = at(first).start;
  ledger_.take_back(tag_, first);
  tag_.cause = before_;
  if (waited > 0) ledger_.extend(tag_, Part::bus, Phase::arbitration, start, start + waited);
  ledger_.extend(tag_, Part::bus, last.phase, start + waited, last.end);
}

}  // namespace hvp::vp
