#include "app/linux/stream.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>

#include "app/linux/guest_error.h"

namespace hvp::guest {

namespace {

constexpr std::size_t kMostDescriptors = 16;

void take_descriptors(msghdr& message, std::vector<Descriptor>* descriptors) {
  for (cmsghdr* header = CMSG_FIRSTHDR(&message); header != nullptr;
       header = CMSG_NXTHDR(&message, header)) {
    if (header->cmsg_level != SOL_SOCKET || header->cmsg_type != SCM_RIGHTS) continue;
    const std::size_t count = (header->cmsg_len - CMSG_LEN(0)) / sizeof(int);
    for (std::size_t i = 0; i < count; ++i) {
      int number = -1;
      std::memcpy(&number, CMSG_DATA(header) + i * sizeof number, sizeof number);
      Descriptor descriptor(number);
      if (descriptors != nullptr && descriptors->size() < kMostDescriptors) {
        descriptors->push_back(std::move(descriptor));
      }
    }
  }
}

}  // namespace

// NOLINTNEXTLINE(readability-make-member-function-const): the other end hears of it
void Stream::send(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(number(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) throw GuestGone();
    bytes = bytes.subspan(static_cast<std::size_t>(sent));
  }
}

void Stream::receive(std::span<std::uint8_t> bytes, std::vector<Descriptor>* descriptors) {
  while (!bytes.empty()) {
    alignas(cmsghdr) std::array<char, CMSG_SPACE(kMostDescriptors * sizeof(int))> control{};
    iovec into{bytes.data(), bytes.size()};
    msghdr message{};
    message.msg_iov = &into;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t count = recvmsg(number(), &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
      const std::array sources = {number()};
      process_->wait_readable(sources);
      continue;
    }
    if (count <= 0) throw GuestGone();
    take_descriptors(message, descriptors);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

Listener::Listener(const std::filesystem::path& path)
    : descriptor_(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = path.string();
  if (name.size() >= sizeof address.sun_path) {
    throw std::runtime_error(
        fmt::format("a socket's path of {} characters, expected less than {}: "
                    "name a shorter folder in TMPDIR",
                    name.size(), sizeof address.sun_path));
  }
  std::memcpy(static_cast<char*>(address.sun_path), name.c_str(), name.size() + 1);
  const auto* const at = reinterpret_cast<const sockaddr*>(&address);
  if (!descriptor_ || bind(number(), at, sizeof address) != 0 || listen(number(), 1) != 0) {
    throw std::system_error(errno, std::generic_category(), "no socket for the guest");
  }
}

Stream Listener::accept(GuestProcess& process) {
  Descriptor connection(accept4(number(), nullptr, nullptr, SOCK_CLOEXEC));
  if (!connection) {
    throw std::system_error(errno, std::generic_category(), "no connection to the guest");
  }
  descriptor_.reset();
  return {std::move(connection), process};
}

}  // namespace hvp::guest
