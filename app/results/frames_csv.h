#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/results/part_stream.h"
#include "vp/ledger.h"
#include "vp/session.h"

namespace hvp::results {

// Timing only, nobody computes forces or words: their fields are empty.
enum class Columns { all, times };

// The columns of frames.csv in their order, with a line of help.
struct FrameColumn {
  std::string name;
  std::string help;
};
std::vector<FrameColumn> frame_columns();

// frames.csv: a line a frame, times since the servo loop began.
class FramesCsv : public vp::FrameSink {
 public:
  FramesCsv(const std::filesystem::path& path, const vp::Session& session, vp::Picoseconds budget,
            Columns columns = Columns::all);

  void take(const vp::Frame& frame, const std::vector<vp::SpanId>& critical_path) override;
  void finish() { stream_.finish(); }

 private:
  PartStream stream_;
  const vp::Session& session_;
  vp::Picoseconds budget_;
  Columns columns_;
};

}  // namespace hvp::results
