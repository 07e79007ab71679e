# Writes files as text into a C++ source, with a function that has them:
#   cmake -D OUTPUT=f.cpp -D FUNCTION=f -D "FILES=devices/A.toml;devices/B.toml" -P embed.cmake
set(items "")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME_WLE)
  file(READ ${file} text)
  string(APPEND items "    {\"${name}\", R\"device(${text})device\"},\n")
endforeach()
file(WRITE ${OUTPUT} "// Written by app/devices/embed.cmake from TOML files.
#include <array>

#include \"app/devices/embedded.h\"

namespace hvp::devices {

std::span<const EmbeddedFile> ${FUNCTION}() {
  static constexpr auto kFiles = std::to_array<EmbeddedFile>({
${items}  });
  return kFiles;
}

}  // namespace hvp::devices
")
