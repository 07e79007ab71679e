#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "app/results/unfinished_file.h"

namespace hvp::results {

// A result file that grows during the run: written as "<path>.part" and renamed by finish(). One
// that is not finished is removed.
class PartStream {
 public:
  // Throws std::runtime_error where the file cannot be created.
  explicit PartStream(std::filesystem::path path);
  ~PartStream();
  PartStream(const PartStream&) = delete;
  PartStream& operator=(const PartStream&) = delete;

  void write(std::string_view text);
  // Over what was written from that byte on.
  void overwrite(std::size_t at, std::string_view text);
  // Throws std::runtime_error where the disk would not take it all.
  void finish();

 private:
  std::filesystem::path path_;
  UnfinishedFile part_;
  std::ofstream stream_;
  bool finished_ = false;
};

}  // namespace hvp::results
