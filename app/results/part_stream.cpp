#include "app/results/part_stream.h"

#include <stdexcept>
#include <system_error>
#include <utility>

namespace hvp::results {

PartStream::PartStream(std::filesystem::path path)
    : path_(std::move(path)), part_(path_.string() + ".part") {
  stream_.open(part_, std::ios::binary | std::ios::trunc);
  if (!stream_) throw std::runtime_error("cannot write " + part_.string());
}

PartStream::~PartStream() {
  if (finished_) return;
  stream_.close();
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
}

void PartStream::write(std::string_view text) {
  stream_.write(text.data(), static_cast<std::streamsize>(text.size()));
}

void PartStream::finish() {
  stream_.close();
  if (!stream_) throw std::runtime_error("cannot write " + part_.string() + ": is the disk full?");
  std::filesystem::rename(part_, path_);
  finished_ = true;
}

}  // namespace hvp::results
