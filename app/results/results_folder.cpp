#include "app/results/results_folder.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "app/results/part_files.h"
#include "app/scenario/writer.h"
#include "app/scene/scenario.h"
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
    std::string_view("engine.fst"),      std::string_view("engine.part.fst"),
    std::string_view("registers.vcd"),   std::string_view("registers.part.vcd"),
    std::string_view("jobs.hvpf"),       std::string_view("jobs.hvpu"),
    std::string_view("dma.log"),         std::string_view("engine-port.txt")};

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

void remove_earlier_results(const fs::path& folder, const std::vector<std::string>& but) {
  try {
    std::vector<fs::path> earlier;
    for (const auto& entry : fs::directory_iterator(folder)) {
      const std::string name = entry.path().filename().string();
      if (is_result(name) && std::ranges::find(but, name) == but.end()) {
        earlier.push_back(entry.path());
      }
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

namespace {

constexpr const char* kStem = "scenario.resolved";

void copy_through_part_file(const fs::path& from, const fs::path& to) {
  std::error_code error;
  // A resolved scenario that is run into its own folder.
  if (fs::equivalent(from, to, error)) return;
  const UnfinishedFile unfinished(part_of(to));
  const fs::path& part = unfinished.path();
  error.clear();
  fs::copy_file(from, part, fs::copy_options::overwrite_existing, error);
  if (!error) fs::rename(part, to, error);
  if (!error) return;
  const std::string cause = error.message();
  fs::remove(part, error);
  throw std::runtime_error(fmt::format("cannot write {}: {}", to.string(), cause));
}

// The names of the copied files.
std::string device_name() { return std::string(kStem) + ".device.toml"; }

std::string surface_name(const std::string& stem, const std::string& file) {
  std::string extension = fs::path(file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return stem + extension;
}

// A surface that a scenario names, and the start of its copy's name.
struct NamedSurface {
  std::string stem;
  config::File* file;
};

// Those of the body and of its regions.
std::vector<NamedSurface> surfaces_of(app::Scenario& scenario) {
  std::vector<NamedSurface> surfaces = {{kStem, &scenario.object.mesh.surface}};
  for (std::size_t i = 0; i < scenario.object.regions.size(); ++i) {
    surfaces.push_back(
        {fmt::format("{}.region{}", kStem, i), &scenario.object.regions[i].volume.surface});
  }
  return surfaces;
}

// The surfaces of an earlier run: the body's with another extension, and regions'.
void remove_other_surfaces(const fs::path& directory, const std::set<std::string>& kept) {
  constexpr std::string_view kRegion = ".region";
  std::error_code ignored;
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator(directory, ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kStem) || kept.contains(name)) continue;
    std::string_view middle = std::string_view(name).substr(std::string_view(kStem).size());
    if (middle.starts_with(kRegion)) {
      middle.remove_prefix(kRegion.size());
      middle.remove_prefix(std::min(middle.find_first_not_of("0123456789"), middle.size()));
    }
    for (const std::string_view extension : {".stl", ".ply", ".obj", ".vtp", ".vtu"}) {
      if (middle == extension) old.push_back(entry.path());
    }
  }
  for (const fs::path& path : old) fs::remove(path, ignored);
}

}  // namespace

std::string resolved_text(const app::Scenario& scenario, const fs::path& device) {
  app::Scenario resolved = scenario;
  // The resolved text has all parameters of the model's file, and those that the user removed must
  // stay removed.
  resolved.device.model.clear();
  for (plant::Probe& probe : resolved.probes) {
    if (probe.device) probe.device->model.clear();
  }
  if (!device.empty()) resolved.accelerator.device = device_name();
  for (const NamedSurface& surface : surfaces_of(resolved)) {
    if (surface.file->empty()) continue;
    *surface.file = config::File(surface_name(surface.stem, surface.file->path));
  }
  return scenario::resolved(resolved);
}

void write_resolved_scenario(const fs::path& directory, const app::Scenario& scenario,
                             const fs::path& device) {
  if (!device.empty()) {
    copy_through_part_file(device, directory / device_name());
  } else {
    std::error_code ignored;
    fs::remove(directory / device_name(), ignored);  // of an earlier run
  }
  app::Scenario named = scenario;
  std::set<std::string> copies;
  for (const NamedSurface& surface : surfaces_of(named)) {
    if (surface.file->empty()) continue;
    const std::string copy = surface_name(surface.stem, surface.file->path);
    copy_through_part_file(surface.file->path, directory / copy);
    copies.insert(copy);
  }
  remove_other_surfaces(directory, copies);
  write_through_part_file(directory / (std::string(kStem) + ".toml"),
                          resolved_text(scenario, device));
}

}  // namespace hvp::results
