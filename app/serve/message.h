#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "app/serve/file_descriptor.h"
#include "app/serve/vfio_user.h"

namespace hvp::serve {

using Bytes = std::vector<std::uint8_t>;

// A command that is answered with an error number of errno.h. The session continues.
class Refused : public std::runtime_error {
 public:
  Refused(int error, const std::string& why) : std::runtime_error(why), error_(error) {}
  int error() const { return error_; }

 private:
  int error_;
};

// A violation of the protocol after which nothing of the client can be understood. The session
// ends.
class Broken : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Message {
  Header header;
  Bytes body;
  std::vector<FileDescriptor> files;
};

// Throws Broken if the header does not begin a command of an accepted length.
Header parse_header(std::span<const std::uint8_t, sizeof(Header)> bytes);

Bytes reply(const Header& command, std::span<const std::uint8_t> body);
Bytes error_reply(const Header& command, int error);

// Reads a command's body field by field. Throws Refused with EINVAL if the body is too short.
class Fields {
 public:
  explicit Fields(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  template <class T>
  T take() {
    static_assert(std::is_trivially_copyable_v<T>);
    T value;
    const auto bytes = take_bytes(sizeof value);
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
  std::span<const std::uint8_t> take_bytes(std::size_t count) {
    if (count > rest_.size()) throw Refused(EINVAL, "a command that is cut short");
    return std::exchange(rest_, rest_.subspan(count)).first(count);
  }
  std::span<const std::uint8_t> rest() const { return rest_; }

 private:
  std::span<const std::uint8_t> rest_;
};

template <class T>
void append(Bytes& to, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::size_t at = to.size();
  to.resize(at + sizeof value);
  std::memcpy(to.data() + at, &value, sizeof value);
}

// The result of the version negotiation with a client.
struct Agreement {
  std::uint16_t minor = 0;
  // True if the client may send region_write_multi, which needs minor version 1 and the capability.
  bool writes_multiple = false;
};

// Parses the body of a version command, with or without capabilities in JSON. Throws Refused if the
// major version differs or the capabilities are malformed.
Agreement agree(std::span<const std::uint8_t> body);

// The body of the reply, with a minor version no higher than the client's.
Bytes version_reply(const Agreement& agreement);

}  // namespace hvp::serve
