#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "app/scenario/document.h"
#include "models/accel/architecture.h"
#include "models/accel/device.h"

// The FPGAs and the haptic devices that a scenario can name. The files of the top-level folders
// devices/ and haptic-devices/ are built into the program; a user's own files are read in the same
// way.
namespace hvp::devices {

// The names of the built-in FPGAs, in the order of docs/devices.md.
std::vector<std::string_view> built_in_names();

// Throws std::invalid_argument if there is no FPGA of that name.
const accel::Device& built_in(std::string_view name);

// All built-in FPGAs in that order.
std::vector<const accel::Device*> all_built_in();

// Reads an FPGA from a text. Errors name `file_name`. Throws scenario::SourceError.
accel::Device parse(std::string_view text, const std::filesystem::path& file_name);

// True if accelerator.device names a file: the value ends in .toml.
bool names_file(std::string_view device);

// Returns the path of the device file that the scenario names, or an empty path for a built-in
// device. Throws SourceError if there is no such file.
std::filesystem::path openable(const scenario::Document& document, const std::string& device);

// Returns the FPGA that accelerator.device names, built in or from a file relative to the scenario.
// Throws SourceError: with the scenario's line if there is no such device or file, or if it lacks
// the memory types and multipliers that the architecture names; with the device file's line if that
// file is wrong.
accel::Device find(const scenario::Document& document, const accel::Architecture& architecture);

// The names of the built-in haptic devices in alphabetical order.
std::vector<std::string_view> haptic_names();

// Lays the document's [device], and each probe's own, over the file of the haptic device that its
// key `model` names; without that key it does nothing. Throws SourceError if there is no such
// device or file, or if the file is wrong.
void put_devices_under(scenario::Document& document);

}  // namespace hvp::devices
