#include "vp/frame/latency_statistics.h"

#include <algorithm>
#include <cstdlib>

namespace hvp::vp {

std::size_t LatencyStatistics::entry_of(Part part, Phase phase) {
  std::uint16_t& index =
      path_index_[static_cast<std::size_t>(part)].at(static_cast<std::size_t>(phase));
  if (index == 0) {
    // The frames before this one had none of it.
    on_path_.push_back({part, phase, 0, {}});
    on_path_.back().times.add(0, frames());
    index = static_cast<std::uint16_t>(on_path_.size());
  }
  return index - std::size_t{1};
}

statistics::Histogram& LatencyStatistics::transactions_of(Phase phase) {
  std::uint16_t& index = transaction_index_.at(static_cast<std::size_t>(phase));
  if (index == 0) {
    transactions_.push_back({phase, {}});
    index = static_cast<std::uint16_t>(transactions_.size());
  }
  return transactions_[index - std::size_t{1}].times;
}

void LatencyStatistics::closed(const Frame& frame, const CriticalPath& path) {
  for (const Attribution& a : path.attribution()) in_frame_[entry_of(a.part, a.phase)] = a.time;
  for (std::size_t i = 0; i < on_path_.size(); ++i) {
    PathTime& entry = on_path_[i];
    const Picoseconds time = in_frame_[i];
    in_frame_[i] = 0;
    entry.times.add(time);
    if (time > 0) ++entry.frames;
  }
  for (std::size_t i = 0; i < kParts; ++i) parts_[i].add(path.time(static_cast<Part>(i)));
  for (const Span& span : frame.spans) {
    if (span.part == Part::bus) transactions_of(span.phase).add(span.end - span.start);
  }

  const Picoseconds latency = frame.latency();
  const bool first = frames() == 0;
  best_ = first ? latency : std::min(best_, latency);
  if (!first) change_.add(std::abs(latency - last_));
  last_ = latency;
  latency_.add(latency);
}

}  // namespace hvp::vp
