#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <sys/socket.h>
#include <sys/types.h>

#include "app/serve/file_descriptor.h"
#include "app/serve/message.h"

namespace hvp::serve {

// A Unix socket at a path that only its user may connect to (mode 0600). It replaces a socket that
// an ended program has left there, and is removed at the end.
class ListeningSocket {
 public:
  // Throws InputError if another file or a listening socket is there, and if the system refuses the
  // socket (no such folder, a path that is too long).
  explicit ListeningSocket(const std::filesystem::path& path);
  ~ListeningSocket();
  ListeningSocket(const ListeningSocket&) = delete;
  ListeningSocket& operator=(const ListeningSocket&) = delete;

  int number() const { return socket_.number(); }
  // Accepts a waiting client, if there is one.
  std::optional<FileDescriptor> accept();

 private:
  std::filesystem::path path_;
  FileDescriptor socket_;
  // Identify the socket's file, so that a file that replaced it is not removed.
  dev_t device_ = 0;
  ino_t inode_ = 0;
};

// The connection to a client. It transfers whole messages.
class Connection {
 public:
  explicit Connection(FileDescriptor socket) : socket_(std::move(socket)) {}

  int number() const { return socket_.number(); }

  // Reads what has arrived, without waiting, and returns the message when it is complete. Throws
  // Broken if no message can follow: the client has gone, or what it sent is no message.
  std::optional<Message> receive();
  // Throws Broken if the client has gone, or reads nothing for too long.
  void send(std::span<const std::uint8_t> bytes);

  // Ends the replies and reads the rest that the client has sent. Closing the socket with unread
  // data would reset the connection, which QEMU (11.1) does not survive.
  void finish();

 private:
  bool fill(std::span<std::uint8_t> room, std::size_t& filled);
  void keep_files(msghdr& message);
  void wait_for_room() const;

  FileDescriptor socket_;
  std::array<std::uint8_t, sizeof(Header)> header_{};
  std::size_t header_filled_ = 0;
  std::size_t body_filled_ = 0;
  Message message_;  // being received
};

}  // namespace hvp::serve
