#include "app/serve/connection.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "models/config/input_error.h"

namespace hvp::serve {

namespace {

namespace fs = std::filesystem;

// The backlog of the socket: one client is served, and a few more may wait to be refused.
constexpr int kWaiting = 8;

InputError wrong(const fs::path& path, const std::string& why) {
  return InputError(fmt::format("--vfio-user {}: {}", path.string(), why));
}

sockaddr_un address_of(const fs::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string& name = path.native();
  if (name.size() >= sizeof address.sun_path) {
    throw wrong(path, fmt::format("a path of {} bytes: a socket's has at most {}", name.size(),
                                  sizeof address.sun_path - 1));
  }
  std::memcpy(address.sun_path, name.data(), name.size());
  return address;
}

FileDescriptor new_socket() {
  FileDescriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket) throw std::runtime_error(fmt::format("socket: {}", std::strerror(errno)));
  return socket;
}

// Binds under a umask, so that the socket's file never has the masked permissions, not even for a
// moment.
int bind_privately(const FileDescriptor& socket, const sockaddr_un& address) {
  const mode_t before = ::umask(0177);
  const int status =
      ::bind(socket.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address);
  const int error = status == 0 ? 0 : errno;
  ::umask(before);
  return error;
}

// A file that only this process uses. It does not exist at first and is removed with the object.
struct OwnFile {
  explicit OwnFile(fs::path where) : path(std::move(where)) { ::unlink(path.c_str()); }
  ~OwnFile() { ::unlink(path.c_str()); }
  OwnFile(const OwnFile&) = delete;
  OwnFile& operator=(const OwnFile&) = delete;

  fs::path path;
};

void remove_stale(const fs::path& path, const sockaddr_un& address) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0) return;
  if (!S_ISSOCK(status.st_mode)) throw wrong(path, "is there already, and is no socket");
  const FileDescriptor probe = new_socket();
  if (::connect(probe.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ||
      errno != ECONNREFUSED) {
    throw wrong(path, errno == EACCES ? "another user's socket"
                                      : "a server listens there already: expected another path");
  }
  ::unlink(path.c_str());
}

}  // namespace

// The socket gets its path only when it listens, so that a client that waits for the file is not
// refused.
ListeningSocket::ListeningSocket(const fs::path& path) : path_(path), socket_(new_socket()) {
  const sockaddr_un address = address_of(path);
  const fs::path parent = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const FileDescriptor folder(::open(parent.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (!folder) throw wrong(path, std::strerror(errno));
  // The folder is named by its descriptor, so that the hidden path is not too long for a socket.
  const OwnFile hidden(fmt::format("/proc/self/fd/{}/.hvp-{}", folder.number(), ::getpid()));
  if (const int error = bind_privately(socket_, address_of(hidden.path)); error != 0) {
    throw wrong(path, std::strerror(error));
  }
  struct stat status {};
  if (::lstat(hidden.path.c_str(), &status) == 0) {
    device_ = status.st_dev;
    inode_ = status.st_ino;
  }
  if (::listen(socket_.number(), kWaiting) != 0) throw wrong(path, std::strerror(errno));
  if (::link(hidden.path.c_str(), path.c_str()) != 0) {
    if (errno != EEXIST) throw wrong(path, std::strerror(errno));
    remove_stale(path, address);
    if (::link(hidden.path.c_str(), path.c_str()) != 0) throw wrong(path, std::strerror(errno));
  }
  // The path is made absolute, as the working folder may change.
  path_ = fs::absolute(path);
}

ListeningSocket::~ListeningSocket() {
  struct stat status {};
  if (::lstat(path_.c_str(), &status) != 0) return;
  if (status.st_dev == device_ && status.st_ino == inode_) ::unlink(path_.c_str());
}

std::optional<FileDescriptor> ListeningSocket::accept() {
  const int number = ::accept4(socket_.number(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (number < 0) return std::nullopt;
  return FileDescriptor(number);
}

namespace {

// A client that has a message's worth of replies before it and reads none of them for this time has
// stopped.
constexpr int kPatienceMs = 10'000;
// Between two looks for a signal that ends the server.
constexpr int kPieceMs = 100;

// The wait for what the client sends after the last reply: its length and number.
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

// Files arrive with the first byte that was sent beside them. A message is read exactly to its end,
// so that none of the files belongs to another message.
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
  // The kernel closes files for which there was no room.
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
    wait_for_room();
  }
}

// Signals are blocked here (server.cpp): one that has come is looked for.
void Connection::wait_for_room() const {
  pollfd ready{.fd = socket_.number(), .events = POLLOUT, .revents = 0};
  for (int waited = 0; waited < kPatienceMs; waited += kPieceMs) {
    if (::poll(&ready, 1, kPieceMs) != 0) return;
    sigset_t pending{};
    sigpending(&pending);
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
      if (sigismember(&pending, number) == 1) {
        throw Broken("the server ends, and the client takes no replies");
      }
    }
  }
  throw Broken("the client takes no replies");
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
