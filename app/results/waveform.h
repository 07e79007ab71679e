#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "app/results/unfinished_file.h"

namespace hvp::results {

// <name>.vcd, written beside under another name by SystemC's tracer, which opens and closes it. One
// that is not finished is removed.
class WaveformFile {
 public:
  WaveformFile(const std::filesystem::path& folder, std::string_view name);
  ~WaveformFile();
  WaveformFile(const WaveformFile&) = delete;
  WaveformFile& operator=(const WaveformFile&) = delete;

  // For the tracer, which adds ".vcd".
  std::string tracer_file() const;
  // The tracer has closed its file: the date of its header is blanked, so that the same scenario
  // gives the same bytes, and it gets its name. Throws std::runtime_error where it is not whole.
  void finish();

 private:
  UnfinishedFile part_;
  std::filesystem::path path_;
  bool finished_ = false;
};

}  // namespace hvp::results
