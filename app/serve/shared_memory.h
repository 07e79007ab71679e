#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "app/serve/file_descriptor.h"

namespace hvp::serve {

// A part of a client's file in this process.
//
// Its owner may cut the file off at any time. Who uses the memory asks whole() before; what is cut
// off between that and the access reads as zeros, and what is written there is lost, where the
// system would end the program (SIGBUS).
class SharedMemory {
 public:
  // Throws Refused with the errno: no regular file (a memfd is one), one that ends before, an
  // offset that is no multiple of a page. At most kMostMaps at a time.
  SharedMemory(FileDescriptor file, std::uint64_t offset, std::uint64_t bytes, bool writable);
  ~SharedMemory();
  SharedMemory(SharedMemory&& other) noexcept;
  SharedMemory& operator=(SharedMemory&&) = delete;
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;

  std::span<std::uint8_t> bytes() const { return bytes_; }
  // Whether the file still reaches as far.
  bool whole() const;

 private:
  FileDescriptor file_;
  std::uint64_t end_;  // in the file
  std::span<std::uint8_t> bytes_;
};

}  // namespace hvp::serve
