#include "app/results/x_display.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstring>
#include <string_view>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace hvp::results {
namespace {

// Xlib tries the abstract name first and the file second.
bool listens(const std::string& socket_path, bool abstract) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::size_t start = abstract ? 1 : 0;
  if (start + socket_path.size() >= sizeof(address.sun_path)) return false;
  std::memcpy(address.sun_path + start, socket_path.data(), socket_path.size());
  const auto size =
      static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + start + socket_path.size());
  const int descriptor = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) return false;
  const bool connected =
      connect(descriptor, reinterpret_cast<const sockaddr*>(&address), size) == 0;
  close(descriptor);
  return connected;
}

}  // namespace

bool local_display_answers(const std::string& display) {
  std::string_view name = display;
  if (name.starts_with("unix:")) name.remove_prefix(4);
  if (!name.starts_with(':')) return false;
  name.remove_prefix(1);
  name = name.substr(0, name.find('.'));
  if (name.empty() ||
      !std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c) != 0; }))
    return false;
  const std::string socket_path = "/tmp/.X11-unix/X" + std::string(name);
  return listens(socket_path, true) || listens(socket_path, false);
}

}  // namespace hvp::results
