#include "app/serve/message.h"

#include <fmt/format.h>

namespace hvp::serve {

namespace {

Bytes message(const Header& header, std::span<const std::uint8_t> body) {
  Bytes bytes;
  bytes.reserve(sizeof header + body.size());
  append(bytes, header);
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

}  // namespace

Header parse_header(std::span<const std::uint8_t, sizeof(Header)> bytes) {
  Header header;
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.size < sizeof(Header) || header.size > kLargestMessage) {
    throw Broken(fmt::format("a message of {} bytes: expected {} to {}", header.size,
                             sizeof(Header), kLargestMessage));
  }
  // This server asks its client for nothing, so that no reply is due.
  if ((header.flags & kTypeMask) != 0) {
    throw Broken(fmt::format("a message of type {}: expected a command", header.flags & kTypeMask));
  }
  return header;
}

Bytes reply(const Header& command, std::span<const std::uint8_t> body) {
  return message({.id = command.id,
                  .command = command.command,
                  .size = static_cast<std::uint32_t>(sizeof(Header) + body.size()),
                  .flags = kReplyType,
                  .error = 0},
                 body);
}

Bytes error_reply(const Header& command, int error) {
  return message({.id = command.id,
                  .command = command.command,
                  .size = sizeof(Header),
                  .flags = kReplyType | kErrorFlag,
                  .error = static_cast<std::uint32_t>(error)},
                 {});
}

}  // namespace hvp::serve
