# Writes devices/*.toml as text into a C++ source:
#   cmake -D OUTPUT=embedded.cpp -D "FILES=devices/A.toml;devices/B.toml" -P embed.cmake
set(items "")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME_WE)
  file(READ ${file} text)
  string(APPEND items "    {\"${name}\", R\"device(${text})device\"},\n")
endforeach()
file(WRITE ${OUTPUT} "// Written by app/devices/embed.cmake from devices/*.toml.
#include <array>

#include \"app/devices/embedded.h\"

namespace hvp::devices {

std::span<const EmbeddedFile> embedded_files() {
  static constexpr auto kFiles = std::to_array<EmbeddedFile>({
${items}  });
  return kFiles;
}

}  // namespace hvp::devices
")
