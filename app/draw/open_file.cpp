#include "app/draw/open_file.h"

#include "models/config/input_error.h"

namespace hvp::draw {

std::ifstream open_file(const std::filesystem::path& path) {
  // A pipe in its place would be waited for.
  std::ifstream file;
  if (std::filesystem::is_regular_file(path)) file.open(path, std::ios::binary);
  if (!file.is_open()) throw InputError(path.filename().string() + ": no such file");
  return file;
}

}  // namespace hvp::draw
