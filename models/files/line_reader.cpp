#include "models/files/line_reader.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::files {
namespace {

[[noreturn]] void refuse() {
  throw InputError(fmt::format("a line of more than {} bytes: expected rows of a table",
                               LineReader::kLongestLine));
}

}  // namespace

bool LineReader::next() {
  std::size_t searched = 0;
  const void* end = nullptr;
  while (end == nullptr) {
    const std::size_t rest = end_ - begin_ - searched;
    if (rest > 0) end = std::memchr(&buffer_[begin_ + searched], '\n', rest);
    if (end != nullptr) break;
    searched = end_ - begin_;
    if (searched > kLongestLine) refuse();
    if (at_end_) break;
    read_more();
  }
  if (end == nullptr && begin_ == end_) {
    line_ = {};
    return false;
  }
  const char* const first = &buffer_[begin_];
  const std::size_t length =
      end == nullptr ? searched : static_cast<std::size_t>(static_cast<const char*>(end) - first);
  if (length > kLongestLine) refuse();
  begin_ += length + (end == nullptr ? 0 : 1);
  line_ = std::string_view(first, length);
  if (line_.ends_with('\r')) line_.remove_suffix(1);
  ++number_;
  return true;
}

void LineReader::read_more() {
  if (begin_ > 0) {
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_),
              buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
    end_ -= begin_;
    begin_ = 0;
  }
  if (end_ == buffer_.size()) buffer_.resize(2 * buffer_.size());
  in_.read(&buffer_[end_], static_cast<std::streamsize>(buffer_.size() - end_));
  end_ += static_cast<std::size_t>(in_.gcount());
  at_end_ = !in_;
}

}  // namespace hvp::files
