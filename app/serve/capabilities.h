#pragma once

#include <cstdint>
#include <span>

#include "app/serve/message.h"

namespace hvp::serve {

// What is agreed with a client by its first message.
struct Agreement {
  std::uint16_t minor = 0;
  // It may send region_write_multi: of minor 1, where it knows of that.
  bool writes_multiple = false;
};

// The body of a version command, with or without capabilities in JSON. Throws Refused where the
// major version is another one or the capabilities are none.
Agreement agree(std::span<const std::uint8_t> body);

// The body of the reply: a minor no higher than the client's.
Bytes version_reply(const Agreement& agreement);

}  // namespace hvp::serve
