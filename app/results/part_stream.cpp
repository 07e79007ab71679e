#include "app/results/part_stream.h"

#include <stdexcept>
#include <system_error>
#include <utility>

#include "app/results/part_file.h"

namespace hvp::results {

PartStream::PartStream(std::filesystem::path path) : path_(std::move(path)), part_(part_of(path_)) {
  stream_.open(part_.path(), std::ios::binary | std::ios::trunc);
  if (!stream_) throw std::runtime_error("cannot write " + part_.path().string());
}

PartStream::~PartStream() {
  if (finished_) return;
  stream_.close();
  std::error_code ignored;
  std::filesystem::remove(part_.path(), ignored);
}

void PartStream::write(std::string_view text) {
  stream_.write(text.data(), static_cast<std::streamsize>(text.size()));
}

void PartStream::overwrite(std::size_t at, std::string_view text) {
  stream_.seekp(static_cast<std::streamoff>(at));
  write(text);
  stream_.seekp(0, std::ios::end);
}

void PartStream::finish() {
  stream_.close();
  if (!stream_)
    throw std::runtime_error("cannot write " + part_.path().string() + ": is the disk full?");
  std::filesystem::rename(part_.path(), path_);
  finished_ = true;
}

}  // namespace hvp::results
