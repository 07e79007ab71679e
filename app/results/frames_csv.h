#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/results/part_stream.h"
#include "vp/frame/observer.h"

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
class FramesCsv : public vp::FrameObserver {
 public:
  FramesCsv(const std::filesystem::path& path, vp::Picoseconds budget,
            Columns columns = Columns::all);

  void closed(const vp::Frame& frame, const vp::CriticalPath& path) override;
  void finish() { stream_.finish(); }

 private:
  PartStream stream_;
  vp::Picoseconds budget_;
  Columns columns_;
};

}  // namespace hvp::results
