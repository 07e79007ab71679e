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

const scenario::Node* member(const scenario::Node* table, std::string_view name) {
  return table != nullptr && table->is_table() ? table->find(name) : nullptr;
}

// The keys of the tables with a haptic device's keys: [device] and those of [[probe]].
std::vector<std::string> device_keys(const scenario::Document& document) {
  std::vector<std::string> keys = {"device"};
  const scenario::Node* probe = document.root().find("probe");
  if (member(probe, "device") != nullptr) keys.emplace_back("probe.device");
  if (probe == nullptr || !probe->is_array()) return keys;
  for (std::size_t i = 0; i < probe->members.size(); ++i) {
    if (member(&probe->members[i], "device") == nullptr) continue;
    keys.push_back(fmt::format("probe[{}].device", i));
  }
  return keys;
}

}  // namespace

std::vector<std::string_view> haptic_names() {
  std::vector<std::string_view> names;
  for (const EmbeddedFile& file : embedded_haptic_devices()) names.push_back(file.name);
  return names;
}

namespace {

void put_model_under(scenario::Document& document, const std::string& table) {
  const scenario::Node* model = member(document.find(table), "model");
  // The reader refuses a value that is not a text.
  if (model == nullptr || model->text.empty() || model->is_table() || model->is_array()) return;
  const std::string name = model->text;
  const std::string key = table + ".model";
  if (names_file(name)) {
    document.put_file_under(table, scenario::openable_file(document, key, name));
    return;
  }
  const auto files = embedded_haptic_devices();
  const auto file = std::ranges::find(files, name, &EmbeddedFile::name);
  if (file != files.end()) {
    document.put_text_under(table, file->text, fmt::format("haptic-devices/{}.toml", name));
    return;
  }
  const std::vector<std::string_view> names = haptic_names();
  std::string message = fmt::format("expected {} or a file that ends in .toml, found {}",
                                    fmt::join(names, ", "), scenario::in_quotes(name));
  const std::string_view close = scenario::nearest(name, names);
  if (!close.empty()) message += fmt::format("; did you mean \"{}\"?", close);
  throw scenario::SourceError(key, document.locate(key) + message);
}

}  // namespace

void put_devices_under(scenario::Document& document) {
  for (const std::string& table : device_keys(document)) put_model_under(document, table);
}

}  // namespace hvp::devices
