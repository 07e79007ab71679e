#include "app/serve/listening_socket.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "models/config/input_error.h"

namespace hvp::serve {

namespace {

namespace fs = std::filesystem;

// One client is served; a few more may wait to be refused.
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

// The masked bits cannot be given to the socket's file in between.
int bind_privately(const FileDescriptor& socket, const sockaddr_un& address) {
  const mode_t before = ::umask(0177);
  const int status =
      ::bind(socket.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address);
  const int error = status == 0 ? 0 : errno;
  ::umask(before);
  return error;
}

// A file of this process alone, which is not there before and goes with the object.
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

// It comes to its path when it listens: whoever waits for a file there is not refused.
ListeningSocket::ListeningSocket(const fs::path& path) : path_(path), socket_(new_socket()) {
  const sockaddr_un address = address_of(path);
  const fs::path parent = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const FileDescriptor folder(::open(parent.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (!folder) throw wrong(path, std::strerror(errno));
  // By the descriptor, so that a path which is long enough for a socket stays so.
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
  // The program's folder may change no more than the path does.
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

}  // namespace hvp::serve
