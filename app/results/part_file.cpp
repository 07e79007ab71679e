#include "app/results/part_file.h"

#include <cerrno>
#include <fstream>
#include <ios>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

#include "app/results/unfinished_file.h"

namespace hvp::results {

std::filesystem::path part_of(const std::filesystem::path& path) {
  std::filesystem::path part = path;
  part += ".part";
  // Whatever has that name already, a pipe or a link to elsewhere, is not written into.
  std::error_code ignored;
  std::filesystem::remove(part, ignored);
  return part;
}

void write_through_part_file(const std::filesystem::path& path, std::string_view bytes) {
  const UnfinishedFile unfinished(part_of(path));
  const std::filesystem::path& part = unfinished.path();
  errno = 0;
  std::ofstream file(part, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  std::error_code error;
  if (!file) {
    const int cause = errno;
    std::filesystem::remove(part, error);
    throw std::runtime_error(
        fmt::format("cannot write {}: {}", path.string(),
                    cause != 0 ? std::generic_category().message(cause) : "write failed"));
  }
  std::filesystem::rename(part, path, error);
  if (error) {
    const std::string cause = error.message();
    std::filesystem::remove(part, error);
    throw std::runtime_error(fmt::format("cannot write {}: {}", path.string(), cause));
  }
}

}  // namespace hvp::results
