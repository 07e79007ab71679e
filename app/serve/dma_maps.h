#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "app/serve/file_descriptor.h"
#include "app/serve/function_port.h"
#include "app/serve/message.h"

namespace hvp::serve {

// A mapped part of a client's file.
//
// The client may truncate the file at any time, so whole() is checked before each use. If the file
// is truncated between that check and the access, reads give zeros and writes are lost; without
// this the system would end the program (SIGBUS).
class SharedMemory {
 public:
  // Throws Refused with the errno if the descriptor is not a regular file (a memfd is one), if the
  // file ends before that part, or if the offset is no multiple of a page. At most kMostMaps exist
  // at a time.
  SharedMemory(FileDescriptor file, std::uint64_t offset, std::uint64_t bytes, bool writable);
  ~SharedMemory();
  SharedMemory(SharedMemory&& other) noexcept;
  SharedMemory& operator=(SharedMemory&&) = delete;
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;

  std::span<std::uint8_t> bytes() const { return bytes_; }
  // True if the file still contains the whole part.
  bool whole() const;

 private:
  FileDescriptor file_;
  std::uint64_t end_;  // in the file
  std::span<std::uint8_t> bytes_;
};

// The memory that a client shares with the board. Memory without a file is recorded but not
// accessible: the board's accesses fail there as they do outside all memory. The same applies to
// memory that the client has truncated.
class DmaMaps {
 public:
  // Keeps a reference.
  explicit DmaMaps(FunctionPort& function);
  ~DmaMaps();
  DmaMaps(const DmaMaps&) = delete;
  DmaMaps& operator=(const DmaMaps&) = delete;

  // Both functions throw Refused without changing anything.
  void map(const DmaMap& command, std::vector<FileDescriptor> files);
  // Removes all ranges inside the given one. A range that contains none, or cuts one, is refused.
  void unmap(const DmaUnmap& command);
  void clear();

 private:
  struct Range {
    std::uint64_t bytes;
    std::vector<SharedMemory> memory;  // one, or none
  };
  using Ranges = std::map<std::uint64_t, Range>;  // by address

  void drop_cut_off();
  bool overlaps(std::uint64_t address, std::uint64_t bytes) const;
  Ranges::iterator remove(Ranges::iterator range);

  FunctionPort& function_;
  Ranges ranges_;
};

}  // namespace hvp::serve
