#include "app/results/trace.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "app/results/number_text.h"

namespace hvp::results {

namespace {
// The slices of one lane may only nest. The host waits while the board works, beside everything
// else, and a late frame's release is delayed while the frame before it is still at work.
constexpr int kWaitLane = 10;
constexpr int kReleaseLane = 11;

int lane(const vp::Span& span) {
  switch (span.phase) {
    case vp::Phase::wait:
    case vp::Phase::pipeline:
    case vp::Phase::wake_up:
    case vp::Phase::blocked:
    case vp::Phase::context_switch:
      return kWaitLane;
    case vp::Phase::release:
      return kReleaseLane;
    default:
      return static_cast<int>(span.part) + 1;
  }
}

std::string lane_name(int lane, std::string_view text) {
  return fmt::format(
      ",\n{{\"name\":\"thread_name\",\"ph\":\"M\",\"pid\":1,\"tid\":{0},\"args\":{{\"name\":\"{1}"
      "\"}}}}"
      ",\n{{\"name\":\"thread_sort_index\",\"ph\":\"M\",\"pid\":1,\"tid\":{0},"
      "\"args\":{{\"sort_index\":{0}}}}}",
      lane, text);
}
}  // namespace

Trace::Trace(const std::filesystem::path& path, const vp::Session& session, std::int64_t frames)
    : stream_(path), session_(session), left_(frames) {
  stream_.write("{\"displayTimeUnit\":\"ns\",\"traceEvents\":[\n");
  stream_.write(R"({"name":"process_name","ph":"M","pid":1,"args":{"name":"hvp"}})");
  for (const vp::Part part :
       {vp::Part::host, vp::Part::bus, vp::Part::fpga, vp::Part::daq, vp::Part::device}) {
    stream_.write(lane_name(static_cast<int>(part) + 1, name(part)));
  }
  stream_.write(lane_name(kWaitLane, "host waits"));
  stream_.write(lane_name(kReleaseLane, "release delay"));
}

void Trace::take(const vp::Frame& frame, const std::vector<vp::SpanId>& critical_path) {
  if (left_ == 0) return;
  --left_;
  fmt::memory_buffer text;
  for (std::size_t i = 0; i < frame.spans.size(); ++i) {
    const vp::Span& span = frame.spans[i];
    const bool critical = std::find(critical_path.begin(), critical_path.end(),
                                    static_cast<vp::SpanId>(i)) != critical_path.end();
    fmt::format_to(std::back_inserter(text),
                   ",\n{{\"name\":\"{}\",\"cat\":\"{}\",\"ph\":\"X\",\"pid\":1,\"tid\":{},"
                   "\"ts\":{},\"dur\":{},\"args\":{{\"frame\":{},\"span\":{},\"cause\":{},"
                   "\"critical\":{}}}}}",
                   name(span.phase), name(span.part), lane(span),
                   microseconds(span.start - session_.begin), microseconds(span.end - span.start),
                   frame.number, i, span.cause, critical);
  }
  stream_.write({text.data(), text.size()});
}

void Trace::finish() {
  stream_.write("\n]}\n");
  stream_.finish();
}

}  // namespace hvp::results
