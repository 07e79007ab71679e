#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "app/serve/dma_maps.h"
#include "app/serve/function_port.h"
#include "app/serve/interrupts.h"
#include "app/serve/message.h"

namespace hvp::serve {

// The session of one client: the negotiated version, its memory and its interrupts. At its end the
// board is reset to its state after power-on and has no memory.
class Session {
 public:
  // Keeps a reference.
  explicit Session(FunctionPort& function);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // Executes the message and returns the bytes of the reply, none if the client wants no reply. The
  // message's files are closed, or kept as long as they are needed. Throws Broken if a command
  // comes before the version is negotiated.
  Bytes take(Message message);

  // True after a version was negotiated.
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
