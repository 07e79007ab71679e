#include "app/results/waveform.h"

#include <fstream>
#include <ios>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

namespace hvp::results {

namespace {

// The tracer does not say whether the disk took all: a whole file ends with its last line's end.
bool ends_with_a_line(std::fstream& file) {
  file.seekg(-1, std::ios::end);
  return file.get() == '\n';
}

// The line behind "$date".
void blank_date(std::fstream& file) {
  file.seekg(0);
  std::string line;
  while (std::getline(file, line) && !line.starts_with("$date")) {
  }
  const std::streampos begin = file.tellg();
  if (!std::getline(file, line) || line.starts_with('$')) return;
  file.seekp(begin);
  file << std::string(line.size(), ' ');
}

}  // namespace

WaveformFile::WaveformFile(const std::filesystem::path& folder, std::string_view name)
    : part_(folder / fmt::format("{}.part.vcd", name)),
      path_(folder / fmt::format("{}.vcd", name)) {}

WaveformFile::~WaveformFile() {
  if (finished_) return;
  std::error_code ignored;
  std::filesystem::remove(part_.path(), ignored);
}

std::string WaveformFile::tracer_file() const {
  std::filesystem::path file = part_.path();
  return file.replace_extension().string();
}

void WaveformFile::finish() {
  {
    std::fstream file(part_.path(), std::ios::binary | std::ios::in | std::ios::out);
    if (file && ends_with_a_line(file)) blank_date(file);
    file.close();
    if (!file) throw std::runtime_error(fmt::format("cannot write {}", path_.string()));
  }
  std::filesystem::rename(part_.path(), path_);
  finished_ = true;
}

}  // namespace hvp::results
