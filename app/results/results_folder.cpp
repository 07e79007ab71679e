#include "app/results/results_folder.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "models/config/input_error.h"

namespace hvp::results {
namespace {

namespace fs = std::filesystem;

constexpr std::array kResultNames = {
    std::string_view("summary.json"),    std::string_view("frames.csv"),
    std::string_view("trace.json"),      std::string_view("performance.json"),
    std::string_view("registers.log"),   std::string_view("scenario.resolved.toml"),
    std::string_view("deformation.pvd"), std::string_view("deformation.png"),
    std::string_view("latency.png"),     std::string_view("loop.png"),
    std::string_view("engine.vcd"),      std::string_view("engine.part.vcd"),
    std::string_view("registers.vcd"),   std::string_view("registers.part.vcd"),
    std::string_view("jobs.hvpf"),       std::string_view("jobs.hvpu")};

[[noreturn]] void refuse(std::string_view option, const fs::path& folder, std::string_view why) {
  throw InputError(fmt::format("{} {}: {}", option, folder.string(), why));
}

// deformation_000025.vtu
bool is_step(std::string_view name) {
  constexpr std::string_view kPrefix = "deformation_";
  constexpr std::string_view kSuffix = ".vtu";
  if (!name.starts_with(kPrefix) || !name.ends_with(kSuffix)) return false;
  name.remove_prefix(kPrefix.size());
  name.remove_suffix(kSuffix.size());
  return name.size() >= 6 && std::all_of(name.begin(), name.end(),
                                         [](unsigned char c) { return std::isdigit(c) != 0; });
}

bool is_result(std::string_view name) {
  if (name.ends_with(".part")) name.remove_suffix(5);
  return is_step(name) ||
         std::find(kResultNames.begin(), kResultNames.end(), name) != kResultNames.end();
}

}  // namespace

void create_folder(const fs::path& folder, std::string_view option) {
  if (folder.empty()) throw InputError(fmt::format("{}: expected a folder, found \"\"", option));
  for (fs::path place = folder; !place.empty(); place = place.parent_path()) {
    std::error_code ignored;
    const fs::file_status status = fs::status(place, ignored);
    if (fs::exists(status) && !fs::is_directory(status)) {
      refuse(option, folder,
             place == folder ? "is a file: expected a folder"
                             : fmt::format("{} is a file: expected a folder", place.string()));
    }
    if (fs::exists(status) || place == place.root_path()) break;
  }
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) refuse(option, folder, "cannot be created: " + error.message());
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    refuse(option, folder, "cannot be written into: " + std::generic_category().message(errno));
  }
}

void remove_earlier_results(const fs::path& folder) {
  try {
    std::vector<fs::path> earlier;
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (is_result(entry.path().filename().string())) earlier.push_back(entry.path());
    }
    for (const fs::path& path : earlier) fs::remove(path);
  } catch (const fs::filesystem_error& error) {
    throw std::runtime_error(fmt::format("cannot clear {} of an earlier run's results: {}",
                                         folder.string(), error.code().message()));
  }
}

FolderLock::FolderLock(const std::filesystem::path& folder)
    : descriptor_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (descriptor_ < 0 || flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  close(descriptor_);
  throw InputError("--out: another run is writing into " + folder.string() +
                   "; expected a folder of its own for each run");
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

}  // namespace hvp::results
