// The reader of device files on arbitrary bytes. What must hold: it throws nothing but a
// SourceError of one line, and every device that it accepts can be asked what a system takes of it.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "app/devices/devices.h"
#include "app/scenario/document.h"
#include "models/accel/fit.h"
#include "models/accel/memory.h"
#include "models/config/input_error.h"

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

void ask(const hvp::accel::Device& device) {
  const hvp::accel::Pattern pattern{std::vector<int>(500, 13)};
  for (const auto method : {hvp::fixed::Method::cg, hvp::fixed::Method::jacobi_pcg}) {
    const hvp::accel::WordLengths words{.method = method};
    try {
      const hvp::accel::Usage usage = hvp::accel::usage(device, {}, words, pattern);
      require(std::ranges::all_of(usage.resources, [](const auto& r) { return r.used >= 0; }));
      hvp::accel::require_fit(device, {}, words, pattern);
      require(usage.fits());
    } catch (const hvp::InputError& error) {
      require(!error.key().empty());
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  try {
    ask(hvp::devices::parse(text, "x.toml"));
  } catch (const hvp::scenario::SourceError& error) {
    const std::string_view line = error.what();
    require(!line.empty() && line.size() < 10000);
    require(std::none_of(line.begin(), line.end(),
                         [](char c) { return static_cast<unsigned char>(c) < 0x20; }));
  }
  return 0;
}
