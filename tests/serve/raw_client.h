#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>

#include "app/serve/message.h"

namespace hvp::test {

// A connection that sends whatever a test wants, and that waits for no answer for ever.
class RawClient {
 public:
  explicit RawClient(const std::filesystem::path& path)
      : socket_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.native().copy(address.sun_path, sizeof address.sun_path - 1);
    const timeval patience{.tv_sec = 60, .tv_usec = 0};
    ::setsockopt(number(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    ::setsockopt(number(), SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    if (::connect(number(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      throw std::runtime_error("cannot connect");
    }
  }

  int number() const { return socket_.number(); }
  void send(std::span<const std::uint8_t> bytes) {
    ::send(number(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }
  void send(serve::Request command, const serve::Bytes& body) { send(message(command, body)); }
  static serve::Bytes message(serve::Request command, const serve::Bytes& body,
                              std::uint32_t flags = 0) {
    serve::Bytes bytes;
    serve::append(bytes, serve::Header{.id = 1,
                                       .command = static_cast<std::uint16_t>(command),
                                       .size = static_cast<std::uint32_t>(sizeof(serve::Header) +
                                                                          body.size()),
                                       .flags = flags});
    bytes.insert(bytes.end(), body.begin(), body.end());
    return bytes;
  }
  // The next reply's header; none where the server has closed the connection.
  std::optional<serve::Header> reply() {
    serve::Header header;
    if (!receive(&header, sizeof header)) return std::nullopt;
    serve::Bytes body(header.size - sizeof header);
    if (!body.empty() && !receive(body.data(), body.size())) return std::nullopt;
    return header;
  }
  bool agree() {
    send(serve::Request::version, {0, 0, 1, 0});
    const std::optional<serve::Header> header = reply();
    return header && header->error == 0;
  }
  void close() { socket_.reset(); }

 private:
  bool receive(void* data, std::size_t bytes) {
    return ::recv(number(), data, bytes, MSG_WAITALL) == static_cast<ssize_t>(bytes);
  }

  serve::FileDescriptor socket_;
};

}  // namespace hvp::test
