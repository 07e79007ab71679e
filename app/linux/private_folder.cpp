#include "app/linux/private_folder.h"

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

#include <fmt/format.h>

namespace hvp::guest {

PrivateFolder::PrivateFolder() {
  std::error_code error;
  const std::filesystem::path temporary = std::filesystem::temp_directory_path(error);
  std::string name = (temporary / "hvp-linux-XXXXXX").string();
  // Its mode is 0700 (POSIX, mkdtemp).
  if (error || mkdtemp(name.data()) == nullptr) {
    throw std::runtime_error(
        fmt::format("no folder for the guest's sockets: {}",
                    error ? error.message() : std::generic_category().message(errno)));
  }
  path_ = name;
}

PrivateFolder::~PrivateFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace hvp::guest
