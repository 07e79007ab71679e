#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "app/serve/capabilities.h"
#include "app/serve/dma_maps.h"
#include "app/serve/function_port.h"
#include "app/serve/interrupts.h"
#include "app/serve/message.h"

namespace hvp::serve {

// One client, from its first message to its last: what was agreed, its memory, its interrupts. When
// it ends the board is as after power-on and has no memory.
class Session {
 public:
  // Keeps a reference.
  explicit Session(FunctionPort& function);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // Does what the message says. The reply's bytes; none where none is wanted. The message's files
  // are closed by then, or kept for as long as they are of use. Throws Broken for a message before
  // the first one's time.
  Bytes take(Message message);

  // Whether a version was agreed.
  bool open() const { return open_; }
  Interrupts& interrupts() { return interrupts_; }

 private:
  Bytes answer(Message& message);
  Bytes begin(const Message& message);
  Bytes describe_region(Fields fields) const;
  Bytes describe_interrupt(Fields fields) const;
  void set_interrupts(Message& message);
  Bytes read(Fields fields);
  Bytes write(Fields fields);
  Bytes write_multiple(Fields fields);

  std::uint64_t region_bytes(std::uint32_t region) const;
  void check(const RegionAccess& access) const;
  void write(const RegionAccess& access, std::span<const std::uint8_t> data);

  FunctionPort& function_;
  bool open_ = false;
  Agreement agreement_;
  Interrupts interrupts_;
  DmaMaps memory_;
};

}  // namespace hvp::serve
