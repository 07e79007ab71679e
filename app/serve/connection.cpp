#include "app/serve/connection.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <fmt/format.h>
#include <poll.h>

namespace hvp::serve {

namespace {

// A client that has a message's worth of replies before it and reads none of them for so long
// stands still.
constexpr int kPatienceMs = 10'000;

// What it sends after the last reply is waited for so long, so often.
constexpr int kLastWaitMs = 50;
constexpr int kLastReads = 1000;

}  // namespace

std::optional<Message> Connection::receive() {
  if (header_filled_ < header_.size()) {
    if (!fill(header_, header_filled_)) return std::nullopt;
    message_.header = parse_header(header_);
    message_.body.resize(message_.header.size - sizeof(Header));
    body_filled_ = 0;
  }
  if (!fill(message_.body, body_filled_)) return std::nullopt;
  header_filled_ = 0;
  return std::exchange(message_, Message());
}

// Files come with the first byte that was sent beside them; a message is read to its end and no
// further, so that none of them are another message's.
bool Connection::fill(std::span<std::uint8_t> room, std::size_t& filled) {
  while (filled < room.size()) {
    iovec part{.iov_base = room.data() + filled, .iov_len = room.size() - filled};
    alignas(cmsghdr) std::array<char, CMSG_SPACE(kMostFiles * sizeof(int))> control{};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t got = ::recvmsg(socket_.number(), &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return false;
    if (got < 0) throw Broken(fmt::format("the connection ended: {}", std::strerror(errno)));
    keep_files(message);
    if (got == 0)
      throw Broken(header_filled_ > 0 ? "the client left in the middle of a message" : "");
    filled += static_cast<std::size_t>(got);
  }
  return true;
}

void Connection::keep_files(msghdr& message) {
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
    if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_RIGHTS) continue;
    const std::size_t count = (c->cmsg_len - CMSG_LEN(0)) / sizeof(int);
    for (std::size_t i = 0; i < count; ++i) {
      int number = -1;
      std::memcpy(&number, CMSG_DATA(c) + i * sizeof number, sizeof number);
      message_.files.emplace_back(number);
    }
  }
  // Those that had no room are closed by the kernel.
  if ((message.msg_flags & MSG_CTRUNC) != 0 || message_.files.size() > kMostFiles) {
    throw Broken(fmt::format("a message with more than {} files", kMostFiles));
  }
}

void Connection::send(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t sent =
        ::send(socket_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(sent));
      continue;
    }
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != EWOULDBLOCK) {
      throw Broken(fmt::format("the connection ended: {}", std::strerror(errno)));
    }
    pollfd ready{.fd = socket_.number(), .events = POLLOUT, .revents = 0};
    if (::poll(&ready, 1, kPatienceMs) == 0) throw Broken("the client takes no replies");
  }
}

void Connection::finish() {
  ::shutdown(socket_.number(), SHUT_WR);
  std::array<char, 65536> rest{};
  pollfd ready{.fd = socket_.number(), .events = POLLIN, .revents = 0};
  for (int i = 0; i < kLastReads && ::poll(&ready, 1, kLastWaitMs) == 1; ++i) {
    if (::recv(socket_.number(), rest.data(), rest.size(), MSG_DONTWAIT) <= 0) return;
  }
}

}  // namespace hvp::serve
