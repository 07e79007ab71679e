#include "app/results/trace.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>

#include <fmt/compile.h>
#include <fmt/format.h>

namespace hvp::results {

namespace {

constexpr int kLanesOfARow = 1000;
constexpr std::array<std::string_view, static_cast<std::size_t>(Row::count)> kNames = {
    "host", "host waits", "bus", "bus waits", "fpga", "daq", "device"};
constexpr std::array kRowOfPart = {Row::host, Row::bus, Row::fpga, Row::daq, Row::device};
static_assert(kRowOfPart.size() == vp::kParts, "a part has no row");

}  // namespace

Row row_of(const vp::Span& span) {
  switch (span.phase) {
    case vp::Phase::release:
    case vp::Phase::wake_up:
    case vp::Phase::blocked:
    case vp::Phase::context_switch:
    case vp::Phase::wait:
    case vp::Phase::pipeline:
    case vp::Phase::delay:
      return Row::host_waits;
    case vp::Phase::arbitration:
      return Row::bus_waits;
    default:
      break;
  }
  return kRowOfPart.at(static_cast<std::size_t>(span.part));
}

TraceLanes::Lane TraceLanes::place(Row row, vp::Picoseconds start, vp::Picoseconds end) {
  std::vector<Slices>& lanes = rows_[static_cast<std::size_t>(row)];
  // Slices that only touch do not overlap; one without a length does within another.
  const auto overlaps = [start, end](const Slice& other) {
    return start < other.end && other.start < end;
  };
  auto lane = std::find_if(lanes.begin(), lanes.end(), [&overlaps](const Slices& slices) {
    return std::none_of(slices.begin(), slices.end(), overlaps);
  });
  const bool used = lane != lanes.end();
  if (!used) lane = lanes.emplace(lanes.end());
  lane->push_back({start, end});
  return {first_lane(row) + static_cast<int>(lane - lanes.begin()), used};
}

void TraceLanes::forget_before(vp::Picoseconds time) {
  for (std::vector<Slices>& lanes : rows_) {
    for (Slices& slices : lanes) {
      std::erase_if(slices, [time](const Slice& slice) { return slice.end <= time; });
    }
  }
}

int lane_of(vp::Resource resource) {
  return kLanesOfARow * (static_cast<int>(Row::count) + 1 + static_cast<int>(resource));
}

constexpr int kDmaLane =
    kLanesOfARow * (static_cast<int>(Row::count) + 1 + static_cast<int>(kResources));

int first_lane(Row row) { return kLanesOfARow * (static_cast<int>(row) + 1); }

std::string lane_name(int lane) {
  const int place = lane / kLanesOfARow - 1;
  if (place >= static_cast<int>(Row::count)) {
    const auto resource = static_cast<vp::Resource>(place - static_cast<int>(Row::count));
    // Beside the lane of what frames have to do with it.
    if (resource == vp::Resource::bus) return "bus taken";
    return std::string(vp::name(resource));
  }
  const std::string_view row = kNames[static_cast<std::size_t>(place)];
  const int number = lane % kLanesOfARow;
  return number == 0 ? std::string(row) : fmt::format("{} {}", row, number + 1);
}

namespace {

constexpr std::string_view kEnd = "\n]}\n";
// The most bytes of the mark of a cut and the end of the file.
constexpr std::int64_t kRoomForEnd = 256;

}  // namespace

Trace::Trace(const std::filesystem::path& path, const vp::Session& session,
             const TraceSettings& settings)
    : stream_(path), session_(session), settings_(settings) {
  write("{\"traceEvents\":[\n");
  write(R"({"name":"process_name","ph":"M","pid":1,"args":{"name":"hvp"}})");
  write(",\n");
  write(R"({"name":"process_name","ph":"M","pid":2,"args":{"name":"cores and buses"}})");
  for (int row = 0; row < static_cast<int>(Row::count); ++row) {
    name_lane(first_lane(static_cast<Row>(row)));
  }
  write({text_.data(), text_.size()});
}

void Trace::write(std::string_view text) {
  written_ += static_cast<std::int64_t>(text.size());
  stream_.write(text);
}

void Trace::name_lane(int lane) {
  const int process = lane < lane_of(vp::Resource{}) ? 1 : 2;
  fmt::format_to(std::back_inserter(text_),
                 ",\n{{\"name\":\"thread_name\",\"ph\":\"M\",\"pid\":{2},\"tid\":{0},"
                 "\"args\":{{\"name\":\"{1}\"}}}}"
                 ",\n{{\"name\":\"thread_sort_index\",\"ph\":\"M\",\"pid\":{2},\"tid\":{0},"
                 "\"args\":{{\"sort_index\":{0}}}}}",
                 lane, lane_name(lane), process);
}

bool Trace::fits() const {
  return written_ + static_cast<std::int64_t>(text_.size()) + kRoomForEnd <= settings_.bytes;
}

// Microseconds, exact to the picosecond. Perfetto takes a time as trunc(double · 1000) in
// nanoseconds, and 1.001 · 1000 is less than 1001 in double precision: a nanosecond less would let
// the slice overlap the one before it, and an overlapping slice is dropped. A tenth of a picosecond
// more mends that and is none to who rounds to picoseconds.
void Trace::append_time(vp::Picoseconds time) {
  constexpr vp::Picoseconds kPerUs = 1'000'000;
  fmt::format_to(std::back_inserter(text_), FMT_COMPILE("{}.{:06d}"), time / kPerUs, time % kPerUs);
  const double us = static_cast<double>(time) / static_cast<double>(kPerUs);
  if (static_cast<std::int64_t>(us * 1000.0) < time / 1000) text_.push_back('1');
}

void Trace::append_slice(const vp::Frame& frame, std::size_t index, bool critical) {
  const vp::Span& span = frame.spans[index];
  const TraceLanes::Lane lane = lanes_.place(row_of(span), span.start, span.end);
  lane_ = lane.id;
  if (!lane.used && lane.id != first_lane(row_of(span))) name_lane(lane.id);
  const auto out = std::back_inserter(text_);
  fmt::format_to(out,
                 FMT_COMPILE(",\n{{\"name\":\"{}\",\"cat\":\"{}\",\"ph\":\"X\",\"pid\":1,"
                             "\"tid\":{},\"ts\":"),
                 name(span.phase), name(span.part), lane.id);
  append_time(span.start);
  constexpr vp::Picoseconds kPerUs = 1'000'000;
  const vp::Picoseconds length = span.end - span.start;
  fmt::format_to(out,
                 FMT_COMPILE(",\"dur\":{}.{:06d},\"args\":{{\"frame\":{},\"span\":{},\"cause\":{},"
                             "\"critical\":{}}}}}"),
                 length / kPerUs, length % kPerUs, frame.number, index, span.cause, critical);
}

// Binds to the slice that was written last.
void Trace::append_flow(const vp::Frame& frame, char phase, vp::Picoseconds at) {
  const auto out = std::back_inserter(text_);
  fmt::format_to(out,
                 FMT_COMPILE(",\n{{\"name\":\"frame\",\"cat\":\"path\",\"ph\":\"{}\",\"id\":{},"
                             "\"pid\":1,\"tid\":{},\"ts\":"),
                 phase, frame.number, lane_);
  append_time(at);
  fmt::format_to(out, FMT_COMPILE("{}}}"), phase == 'f' ? ",\"bp\":\"e\"" : "");
}

// The latency as a curve, and what a frame missed.
void Trace::append_marks(const vp::Frame& frame) {
  const auto out = std::back_inserter(text_);
  const auto mark = [&](std::string_view what, vp::Picoseconds at) {
    fmt::format_to(
        out, ",\n{{\"name\":\"{}\",\"ph\":\"i\",\"s\":\"p\",\"pid\":1,\"tid\":{},\"ts\":", what,
        first_lane(Row::device));
    append_time(at);
    fmt::format_to(out, ",\"args\":{{\"frame\":{}}}}}", frame.number);
  };
  constexpr vp::Picoseconds kPerUs = 1'000'000;
  const vp::Picoseconds latency = frame.latency();
  fmt::format_to(out, FMT_COMPILE(",\n{{\"name\":\"latency\",\"ph\":\"C\",\"pid\":1,\"ts\":"));
  append_time(frame.born);
  fmt::format_to(out, FMT_COMPILE(",\"args\":{{\"us\":{}.{:06d}}}}}"), latency / kPerUs,
                 latency % kPerUs);
  if (!frame.solved()) mark("no solution: force held", frame.born + latency);
  if (latency > settings_.budget) mark("late", frame.born + settings_.budget);
}

void Trace::closed(const vp::Frame& frame, const vp::CriticalPath& path) {
  if (frames_ == settings_.frames || cut_at_) return;
  ++frames_;
  text_.clear();
  lanes_.forget_before(frame.born);
  append_marks(frame);
  // A cause comes before what follows it, so that the path's spans ascend.
  const std::vector<vp::SpanId>& critical_path = path.spans();
  auto next = critical_path.begin();
  for (std::size_t i = 0; i < frame.spans.size(); ++i) {
    const auto id = static_cast<vp::SpanId>(i);
    const bool critical = next != critical_path.end() && *next == id;
    append_slice(frame, i, critical);
    if (!critical) continue;
    const bool first = next == critical_path.begin();
    ++next;
    const bool last = next == critical_path.end();
    if (first && last) continue;
    append_flow(frame, first ? 's' : last ? 'f' : 't', frame.spans[i].start);
  }
  if (!fits()) {
    cut(frame.number, frame.born);
    return;
  }
  write({text_.data(), text_.size()});
  next_frame_ = frame.number + 1;
}

// Of a frame that is not drawn.
bool Trace::is_beyond(vp::Picoseconds start) const {
  return session_.begun && settings_.end && start >= session_.begin + *settings_.end;
}

// Set-up has a quarter of the bytes. What it leaves out is said once, in place of the first.
bool Trace::leaves_out_of_set_up(vp::Picoseconds start, vp::Picoseconds end) {
  const bool set_up = !session_.begun || end <= session_.begin;
  if (!set_up || written_ + static_cast<std::int64_t>(text_.size()) <= settings_.bytes / 4) {
    return false;
  }
  text_.clear();
  if (!set_up_cut_) append_mark("set-up is not drawn further", start);
  set_up_cut_ = true;
  write({text_.data(), text_.size()});
  return true;
}

void Trace::take(const vp::Tenure& tenure) {
  if (cut_at_) return;
  if (is_beyond(tenure.start)) return;
  std::optional<vp::Tenure>& last = last_[static_cast<std::size_t>(tenure.resource)];
  const bool goes_on = last && last->end == tenure.start && last->user == tenure.user &&
                       last->what == tenure.what && last->frame == tenure.frame;
  if (goes_on) {
    last->end = tenure.end;
    return;
  }
  flush(last);
  last = tenure;
}

void Trace::flush(std::optional<vp::Tenure>& tenure) {
  if (!tenure || cut_at_) return;
  text_.clear();
  append_tenure(*tenure);
  if (leaves_out_of_set_up(tenure->start, tenure->end)) return;
  if (!fits()) {
    cut(next_frame_, tenure->start);
    return;
  }
  named_[static_cast<std::size_t>(tenure->resource)] = true;
  write({text_.data(), text_.size()});
}

void Trace::transferred(const vp::MasterAccess& access) {
  constexpr vp::Picoseconds kPerUs = 1'000'000;
  if (cut_at_ || is_beyond(access.began)) return;
  text_.clear();
  const auto out = std::back_inserter(text_);
  if (!dma_named_) {
    fmt::format_to(
        out,
        ",\n{{\"name\":\"process_name\",\"ph\":\"M\",\"pid\":3,\"args\":{{\"name\":\"DMA\"}}}}"
        ",\n{{\"name\":\"thread_name\",\"ph\":\"M\",\"pid\":3,\"tid\":{},"
        "\"args\":{{\"name\":\"the board's transfers\"}}}}",
        kDmaLane);
  }
  fmt::format_to(
      out,
      FMT_COMPILE(",\n{{\"name\":\"{}\",\"cat\":\"dma\",\"ph\":\"X\",\"pid\":3,\"tid\":{},\"ts\":"),
      vp::name(access.purpose), kDmaLane);
  append_time(access.began);
  const vp::Picoseconds length = access.ended - access.began;
  fmt::format_to(
      out,
      FMT_COMPILE(",\"dur\":{}.{:06d},\"args\":{{\"access\":\"{}\",\"address\":\"{:#x}\","
                  "\"bytes\":{},\"frame\":{},\"answered\":{}}}}}"),
      length / kPerUs, length % kPerUs, access.read ? "read" : "write", access.address,
      access.data.size(), access.frame, access.answered);
  if (leaves_out_of_set_up(access.began, access.ended)) return;
  if (!fits()) {
    cut(next_frame_, access.began);
    return;
  }
  dma_named_ = true;
  write({text_.data(), text_.size()});
}

void Trace::append_tenure(const vp::Tenure& tenure) {
  const int lane = lane_of(tenure.resource);
  if (!named_[static_cast<std::size_t>(tenure.resource)]) name_lane(lane);
  const std::string_view resource = name(tenure.resource);
  const auto out = std::back_inserter(text_);
  fmt::format_to(
      out,
      FMT_COMPILE(",\n{{\"name\":\"{}\",\"cat\":\"{}\",\"ph\":\"X\",\"pid\":2,\"tid\":{},\"ts\":"),
      tenure.what, resource.substr(0, resource.find(' ')), lane);
  append_time(tenure.start);
  constexpr vp::Picoseconds kPerUs = 1'000'000;
  const vp::Picoseconds length = tenure.end - tenure.start;
  fmt::format_to(out, FMT_COMPILE(",\"dur\":{}.{:06d},\"args\":{{\"by\":\"{}\""), length / kPerUs,
                 length % kPerUs, tenure.user);
  if (tenure.frame >= 0) fmt::format_to(out, FMT_COMPILE(",\"frame\":{}"), tenure.frame);
  fmt::format_to(out, "}}}}");
}

// Across all lanes.
void Trace::append_mark(std::string_view what, vp::Picoseconds at) {
  fmt::format_to(std::back_inserter(text_),
                 ",\n{{\"name\":\"{}\",\"ph\":\"i\",\"s\":\"g\",\"pid\":1,\"tid\":{},\"ts\":", what,
                 first_lane(Row::host));
  append_time(at);
  text_.push_back('}');
}

void Trace::cut(std::int64_t frame, vp::Picoseconds at) {
  cut_at_ = frame;
  text_.clear();
  append_mark(fmt::format("the trace ends here: output.trace_size is {} bytes", settings_.bytes),
              at);
  write({text_.data(), text_.size()});
}

void Trace::finish() {
  for (std::optional<vp::Tenure>& tenure : last_) flush(tenure);
  write(kEnd);
  stream_.finish();
}

}  // namespace hvp::results
