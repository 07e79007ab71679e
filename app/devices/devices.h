#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "app/scenario/document.h"
#include "models/accel/architecture.h"
#include "models/accel/device.h"

// The FPGAs that a scenario can name. Those of the top-level folder devices/ are part of the
// program; the reader is the one of a user's own file.
namespace hvp::devices {

// Names of the built-in devices, in the order of docs/devices.md.
std::vector<std::string_view> built_in_names();

// Throws std::invalid_argument where there is none of that name.
const accel::Device& built_in(std::string_view name);

// All of them, in that order.
std::vector<const accel::Device*> all_built_in();

// A device from its text; `file_name` is what errors call it. Throws scenario::SourceError.
accel::Device parse(std::string_view text, const std::filesystem::path& file_name);

// Whether accelerator.device is meant as a file: it ends in .toml.
bool names_file(std::string_view device);

// The file that can be opened, from the scenario's words; empty for a built-in device. Throws
// SourceError where there is no such file.
std::filesystem::path openable(const scenario::Document& document, const std::string& device);

// The device that accelerator.device names, built in or a file relative to the scenario. Throws
// SourceError: of the scenario's line where there is no such device or file or where it has not the
// memory types and multipliers that the architecture names, of the device's file where that is
// wrong.
accel::Device find(const scenario::Document& document, const accel::Architecture& architecture);

}  // namespace hvp::devices
