#include "app/devices/devices.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "app/devices/embedded.h"
#include "app/scenario/files.h"
#include "app/scenario/message.h"
#include "app/scenario/reader.h"
#include "models/accel/memory.h"

namespace hvp::devices {

namespace {

constexpr std::string_view kKey = "accelerator.device";

std::string unknown_device(const std::string& name) {
  const std::vector<std::string_view> names = built_in_names();
  std::string message = fmt::format("expected {} or a file that ends in .toml, found {}",
                                    fmt::join(names, ", "), scenario::in_quotes(name));
  const std::string_view close = scenario::nearest(name, names);
  if (!close.empty()) message += fmt::format("; did you mean \"{}\"?", close);
  return message;
}

}  // namespace

std::vector<std::string_view> built_in_names() {
  std::vector<std::string_view> names;
  for (const EmbeddedFile& file : embedded_files()) names.push_back(file.name);
  return names;
}

const accel::Device& built_in(std::string_view name) {
  static std::map<std::string_view, accel::Device> known;
  const auto files = embedded_files();
  const auto file = std::ranges::find(files, name, &EmbeddedFile::name);
  if (file == files.end()) {
    throw std::invalid_argument(fmt::format("no built-in device is called {}", name));
  }
  const auto found = known.find(file->name);
  if (found != known.end()) return found->second;
  const std::string path = fmt::format("devices/{}.toml", name);
  return known.emplace(file->name, parse(file->text, path)).first->second;
}

std::vector<const accel::Device*> all_built_in() {
  std::vector<const accel::Device*> all;
  for (const std::string_view name : built_in_names()) all.push_back(&built_in(name));
  return all;
}

accel::Device parse(std::string_view text, const std::filesystem::path& file_name) {
  accel::Device device;
  scenario::read(scenario::Document::parse(text, file_name), device);
  return device;
}

bool names_file(std::string_view device) { return device.ends_with(".toml"); }

std::filesystem::path openable(const scenario::Document& document, const std::string& device) {
  if (!names_file(device)) return {};
  return scenario::openable_file(document, kKey, device);
}

namespace {

accel::Device named(const scenario::Document& document, const std::string& device) {
  if (names_file(device)) {
    accel::Device own;
    scenario::read(scenario::Document::load(openable(document, device)), own);
    return own;
  }
  const std::vector<std::string_view> names = built_in_names();
  if (std::ranges::find(names, device) != names.end()) return built_in(device);
  throw scenario::SourceError(std::string(kKey), document.locate(kKey) + unknown_device(device));
}

}  // namespace

accel::Device find(const scenario::Document& document, const accel::Architecture& architecture) {
  accel::Device device = named(document, architecture.device);
  try {
    accel::require_choices(device, architecture);
  } catch (const InputError& e) {
    throw document.complete(InputError("accelerator." + e.key(), e.what()));
  }
  return device;
}

namespace {

constexpr std::string_view kTable = "device";
constexpr std::string_view kDeviceKey = "device.model";

const scenario::Node* named_model(const scenario::Document& document) {
  const scenario::Node* device = document.root().find(kTable);
  return device != nullptr && device->is_table() ? device->find("model") : nullptr;
}

}  // namespace

std::vector<std::string_view> haptic_names() {
  std::vector<std::string_view> names;
  for (const EmbeddedFile& file : embedded_haptic_devices()) names.push_back(file.name);
  return names;
}

void put_device_under(scenario::Document& document) {
  const scenario::Node* model = named_model(document);
  // The reader refuses a value that is not a text.
  if (model == nullptr || model->text.empty() || model->is_table() || model->is_array()) return;
  const std::string name = model->text;
  if (names_file(name)) {
    document.put_file_under(kTable,
                            scenario::openable_file(document, std::string(kDeviceKey), name));
    return;
  }
  const auto files = embedded_haptic_devices();
  const auto file = std::ranges::find(files, name, &EmbeddedFile::name);
  if (file != files.end()) {
    document.put_text_under(kTable, file->text, fmt::format("haptic-devices/{}.toml", name));
    return;
  }
  const std::vector<std::string_view> names = haptic_names();
  std::string message = fmt::format("expected {} or a file that ends in .toml, found {}",
                                    fmt::join(names, ", "), scenario::in_quotes(name));
  const std::string_view close = scenario::nearest(name, names);
  if (!close.empty()) message += fmt::format("; did you mean \"{}\"?", close);
  throw scenario::SourceError(std::string(kDeviceKey), document.locate(kDeviceKey) + message);
}

}  // namespace hvp::devices
