#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "app/serve/file_descriptor.h"
#include "app/serve/function_port.h"
#include "app/serve/message.h"
#include "app/serve/shared_memory.h"

namespace hvp::serve {

// The memory that a client shares with the board. What comes without a file is noted and not
// reached: the board's accesses there fail, as those beside all memory do. Likewise what a
// client has cut off its file since.
class DmaMaps {
 public:
  // Keeps a reference.
  explicit DmaMaps(FunctionPort& function);
  ~DmaMaps();
  DmaMaps(const DmaMaps&) = delete;
  DmaMaps& operator=(const DmaMaps&) = delete;

  // Both throw Refused, and nothing has changed then.
  void map(const DmaMap& command, std::vector<FileDescriptor> files);
  // All that lies in the range: none, and one that lies there in part, are refused.
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
