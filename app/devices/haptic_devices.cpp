#include "app/devices/haptic_devices.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "app/devices/devices.h"
#include "app/devices/embedded.h"
#include "app/scenario/files.h"
#include "app/scenario/message.h"
#include "app/scenario/nearest.h"

namespace hvp::devices {

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
  // What is no text, the reader refuses.
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
