#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <sys/socket.h>

#include "app/serve/file_descriptor.h"
#include "app/serve/message.h"

namespace hvp::serve {

// A client's end of the socket: whole messages in, whole messages out.
class Connection {
 public:
  explicit Connection(FileDescriptor socket) : socket_(std::move(socket)) {}

  int number() const { return socket_.number(); }

  // What is there of the next message, without waiting; the message, once it is whole. Throws
  // Broken where no message can follow: the client has gone, or sends none.
  std::optional<Message> receive();
  // Throws Broken where the client has gone, or takes nothing for so long that it never will.
  void send(std::span<const std::uint8_t> bytes);

  // Ends the replies, and reads what the client has still sent: closed with that unread, the client
  // would find the connection reset instead of at its end, which QEMU (11.1) does not survive.
  void finish();

 private:
  bool fill(std::span<std::uint8_t> room, std::size_t& filled);
  void keep_files(msghdr& message);

  FileDescriptor socket_;
  std::array<std::uint8_t, sizeof(Header)> header_{};
  std::size_t header_filled_ = 0;
  std::size_t body_filled_ = 0;
  Message message_;  // that is under way
};

}  // namespace hvp::serve
