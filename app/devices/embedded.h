#pragma once

#include <span>
#include <string_view>

namespace hvp::devices {

// A file of devices/ or haptic-devices/ as it was when the program was built.
struct EmbeddedFile {
  std::string_view name;  // "EP2S60"
  std::string_view text;
};

std::span<const EmbeddedFile> embedded_files();
std::span<const EmbeddedFile> embedded_haptic_devices();

}  // namespace hvp::devices
