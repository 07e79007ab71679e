#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "app/serve/file_descriptor.h"
#include "app/serve/message.h"

namespace hvp::serve {

// The interrupts of one client: which eventfd is signalled when.
//
// INTx is a level: it is signalled when it goes up, and is masked with that until the client
// unmasks it; if it is still up then, it is signalled again. A message is an edge, and is lost
// where nobody has given an eventfd for it, as one that is sent to no address.
class Interrupts {
 public:
  explicit Interrupts(bool has_messages) : has_messages_(has_messages) {}

  // Throws Refused for an index beyond kInterruptIndices.
  InterruptInfo info(std::uint32_t index) const;
  // `data`: what follows the structure. Throws Refused, and nothing has changed then.
  void set(const SetInterrupts& command, std::span<const std::uint8_t> data,
           std::vector<FileDescriptor> files);

  void line(bool up);
  void message();

 private:
  struct Source {
    FileDescriptor event;
    bool masked = false;
  };

  void assign(std::uint32_t index, std::vector<FileDescriptor> files);
  void act(std::uint32_t index, std::uint32_t action);
  void show_line();
  Source& source(std::uint32_t index) { return index == kLineIndex ? line_ : message_; }

  bool has_messages_;
  bool up_ = false;
  Source line_;
  Source message_;
};

}  // namespace hvp::serve
