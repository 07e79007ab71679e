#include "models/files/regular_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "models/config/input_error.h"

namespace hvp::files {
namespace {

class Descriptor {
 public:
  // Without waiting: a pipe that takes the place of a file would else be waited for.
  explicit Descriptor(const char* file)
      : number_(::open(file, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }

 private:
  int number_;
};

[[noreturn]] void refuse(int error, std::string_view expected) {
  if (error == ENOENT || error == ENOTDIR) {
    throw InputError(fmt::format("no such file: expected {}", expected));
  }
  throw InputError(fmt::format("cannot be read: {}", std::strerror(error)));
}

void require_regular(const struct stat& status, std::string_view expected) {
  if (S_ISREG(status.st_mode)) return;
  const char* kind = S_ISDIR(status.st_mode)    ? "a folder"
                     : S_ISFIFO(status.st_mode) ? "a pipe"
                     : S_ISSOCK(status.st_mode) ? "a socket"
                                                : "a device";
  throw InputError(fmt::format("is {}: expected {}{}", kind, expected,
                               S_ISDIR(status.st_mode) ? "" : " in a regular file"));
}

std::string bytes_text(std::uintmax_t bytes) {
  constexpr std::uintmax_t kMebi = std::uintmax_t{1} << 20;
  return bytes % kMebi == 0 ? fmt::format("{} MiB", bytes / kMebi) : fmt::format("{} bytes", bytes);
}

}  // namespace

void require_regular_file(const std::filesystem::path& file, std::string_view expected) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) refuse(errno, expected);
  require_regular(status, expected);
}

std::string read_regular_file(const std::filesystem::path& file, std::uintmax_t most_bytes,
                              std::string_view expected) {
  // Before it is opened: to open a device may already do something.
  require_regular_file(file, expected);
  const Descriptor source(file.c_str());
  struct stat status {};
  if (source.number() < 0 || ::fstat(source.number(), &status) != 0) refuse(errno, expected);
  require_regular(status, expected);
  std::string bytes;
  const auto size = static_cast<std::uintmax_t>(std::max<off_t>(status.st_size, 0));
  if (size <= most_bytes) bytes.reserve(static_cast<std::size_t>(size));
  std::array<char, 65536> piece{};
  while (size <= most_bytes) {
    const ssize_t count = ::read(source.number(), piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) refuse(errno, expected);
    if (count == 0) return bytes;
    bytes.append(piece.data(), static_cast<std::size_t>(count));
    if (bytes.size() > most_bytes) break;
  }
  throw InputError(fmt::format("is too large: expected at most {}", bytes_text(most_bytes)));
}

std::ifstream open_regular_file(const std::filesystem::path& file, std::string_view expected) {
  require_regular_file(file, expected);
  std::ifstream in(file, std::ios::binary);
  if (!in.is_open()) refuse(errno, expected);
  return in;
}

}  // namespace hvp::files
