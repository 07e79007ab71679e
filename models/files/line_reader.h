#pragma once

#include <cstddef>
#include <istream>
#include <string_view>
#include <vector>

namespace hvp::files {

// The lines of a text, one after the other, however long it is. A line ends in LF or CRLF, the last
// one also without.
class LineReader {
 public:
  // What a file without line ends takes of the memory, in bytes.
  static constexpr std::size_t kLongestLine = std::size_t{1} << 20U;

  explicit LineReader(std::istream& in) : in_(in), buffer_(std::size_t{1} << 16U) {}

  // Goes on to the next line. False at the end. Throws InputError, with neither file nor line, for
  // one of more than kLongestLine.
  bool next();
  std::string_view line() const { return line_; }  // without its end; until the next one
  std::size_t number() const { return number_; }   // of the line, from 1

 private:
  void read_more();

  std::istream& in_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;  // of what is in the buffer and was not given out
  std::size_t end_ = 0;
  bool at_end_ = false;
  std::string_view line_;
  std::size_t number_ = 0;
};

}  // namespace hvp::files
