#pragma once

#include <cstdint>
#include <filesystem>

#include "app/results/part_stream.h"
#include "vp/ledger.h"
#include "vp/session.h"

namespace hvp::results {

// trace.json: the spans as Chrome trace events, for Perfetto and chrome://tracing. A lane a part,
// and one each for waiting and for the delay of a release; what lies on its frame's critical path
// says so. Times are microseconds since the servo loop began. At most `frames` frames, so that its
// size is bounded.
class Trace : public vp::FrameSink {
 public:
  Trace(const std::filesystem::path& path, const vp::Session& session, std::int64_t frames);

  void take(const vp::Frame& frame, const std::vector<vp::SpanId>& critical_path) override;
  void finish();

 private:
  PartStream stream_;
  const vp::Session& session_;
  std::int64_t left_;
};

}  // namespace hvp::results
