#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "app/serve/file_descriptor.h"
#include "app/serve/message.h"

namespace hvp::serve {

// The interrupts of one client, each signalled through an eventfd.
//
// INTx is a level: it is signalled when it goes up and is then masked until the client unmasks it;
// if it is still up, it is signalled again. A message is an edge; it is lost if the client has set
// no eventfd for it or the message has no address.
class Interrupts {
 public:
  // The index of messages, MSI's or MSI-X's; empty: there are none.
  explicit Interrupts(std::optional<std::uint32_t> messages, bool has_errors = false)
      : messages_(messages), has_errors_(has_errors) {}

  // Throws Refused for an index beyond kInterruptIndices.
  InterruptInfo info(std::uint32_t index) const;
  // `data` is the data behind the structure. Throws Refused without changing anything.
  void set(const SetInterrupts& command, std::span<const std::uint8_t> data,
           std::vector<FileDescriptor> files);

  void line(bool up);
  void message();
  // An edge, as a message is.
  void error();

 private:
  struct Source {
    FileDescriptor event;
    bool masked = false;
  };

  void assign(std::uint32_t index, std::vector<FileDescriptor> files);
  void act(std::uint32_t index, std::uint32_t action);
  void show_line();
  Source& source(std::uint32_t index) {
    if (index == kErrorIndex) return error_;
    return index == kLineIndex ? line_ : message_;
  }

  std::optional<std::uint32_t> messages_;
  bool has_errors_;
  bool up_ = false;
  Source line_;
  Source message_;
  Source error_;
};

}  // namespace hvp::serve
