// The scenario reader on arbitrary bytes. Comments "#set KEY=VALUE" are overrides as well. What
// must hold: it throws nothing but a SourceError of one line, and what it accepts reads back from
// the resolved text as the same values and the same bytes.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "app/scenario/document.h"
#include "app/scenario/quantity.h"
#include "app/scenario/reader.h"
#include "app/scenario/writer.h"
#include "tests/app/scenario/toy_scene.h"

namespace {

using hvp::scenario::Document;
using hvp::scenario::SourceError;
using hvp::scenario::toy::Scene;

void require(bool holds) {
  if (!holds) std::abort();
}

std::vector<std::string> overrides_in(std::string_view text) {
  constexpr std::string_view kMark = "#set ";
  std::vector<std::string> overrides;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    if (line.starts_with(kMark)) overrides.emplace_back(line.substr(kMark.size()));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return overrides;
}

void read_quantities(std::string_view text) {
  for (const auto& entry : hvp::scenario::all_dimensions()) {
    try {
      const double value = hvp::scenario::parse_quantity(text, entry.dimension);
      const std::string written = hvp::scenario::format_quantity(value, entry.dimension);
      require(hvp::scenario::parse_quantity(written, entry.dimension) == value);
    } catch (const hvp::InputError&) {
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  read_quantities(text);
  Scene scene;
  try {
    const Document document = Document::parse(text, "x.toml", overrides_in(text));
    hvp::scenario::read(document, scene);
  } catch (const SourceError& error) {
    const std::string_view line = error.what();
    require(!line.empty() && line.size() < 10000);
    require(std::none_of(line.begin(), line.end(),
                         [](char c) { return static_cast<unsigned char>(c) < 0x20; }));
    return 0;
  }
  const std::string resolved = hvp::scenario::resolved(scene);
  if (resolved.size() > (1U << 20U)) return 0;  // a text of a scenario's largest size grows
  Scene again;
  hvp::scenario::read(Document::parse(resolved, "resolved.toml"), again);
  require(again == scene);
  require(hvp::scenario::resolved(again) == resolved);
  return 0;
}
