#pragma once

#include <string_view>
#include <vector>

#include "app/scenario/document.h"

// The haptic devices that device.model can name. Those of the top-level folder haptic-devices/ are
// part of the program.
namespace hvp::devices {

// Names of the built-in ones, in alphabetical order.
std::vector<std::string_view> haptic_names();

// Puts the file that device.model names under the document's [device], as a base of that table:
// what the scenario states itself counts more. Nothing without the key. Throws SourceError: no such
// device or file, a file that is wrong.
void put_device_under(scenario::Document& document);

}  // namespace hvp::devices
