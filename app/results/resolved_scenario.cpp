#include "app/results/resolved_scenario.h"

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "app/results/part_file.h"
#include "app/results/unfinished_file.h"
#include "app/scenario/writer.h"

namespace hvp::results {
namespace {

namespace fs = std::filesystem;

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

// The surface of an earlier run, with another extension.
void remove_other_surfaces(const fs::path& directory, const std::string& kept) {
  for (const char* extension : {".stl", ".ply", ".obj", ".vtp", ".vtu"}) {
    const std::string name = std::string(kStem) + extension;
    std::error_code ignored;
    if (name != kept) fs::remove(directory / name, ignored);
  }
}

// What comes along, by the name that it has there.
std::string device_name() { return std::string(kStem) + ".device.toml"; }

std::string surface_name(const std::string& file) {
  std::string extension = fs::path(file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return kStem + extension;
}

}  // namespace

std::string resolved_text(const app::Scenario& scenario, const fs::path& device) {
  app::Scenario resolved = scenario;
  // All that it says stands there, and what was taken out of it is to stay out.
  resolved.device.model.clear();
  if (!device.empty()) resolved.accelerator.device = device_name();
  config::File& surface = resolved.object.mesh.surface;
  if (!surface.empty()) surface = config::File(surface_name(surface.path));
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
  const config::File& surface = scenario.object.mesh.surface;
  const std::string surface_copy = surface.empty() ? "" : surface_name(surface.path);
  if (!surface.empty()) copy_through_part_file(surface.path, directory / surface_copy);
  remove_other_surfaces(directory, surface_copy);
  write_through_part_file(directory / (std::string(kStem) + ".toml"),
                          resolved_text(scenario, device));
}

}  // namespace hvp::results
