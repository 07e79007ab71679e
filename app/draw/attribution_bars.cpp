#include "app/draw/attribution_bars.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/draw/canvas.h"
#include "vp/frame/frame.h"

namespace hvp::draw {
namespace {

constexpr Colour kOther = {160, 160, 155};

// After Okabe and Ito's palette for the colour-blind; one part, one colour, in every picture.
constexpr auto kColourOfPart = std::to_array<Colour>({{0, 158, 115},     // host
                                                      {230, 159, 0},     // bus
                                                      {0, 114, 178},     // fpga
                                                      {204, 121, 167},   // daq
                                                      {86, 180, 233}});  // device
static_assert(kColourOfPart.size() == vp::kParts, "a part has no colour");

Colour colour_of(std::string_view part) {
  const auto found = std::ranges::find(vp::kPartNames, part);
  if (found == vp::kPartNames.end()) return kOther;
  return kColourOfPart.at(static_cast<std::size_t>(found - vp::kPartNames.begin()));
}

std::string name_of(const Contribution& row) { return row.part + " · " + row.phase; }

}  // namespace

void draw_attribution(Canvas& canvas, const Deadline& deadline) {
  constexpr double kTop = 322.0;
  constexpr double kRow = 34.0;
  constexpr double kRight = 610.0;
  canvas.text({40.0, 356.0}, "Where the worst frame's time went", {.size = 24, .bold = true});
  const auto rows = largest_contributions(deadline.attribution, 0.01, 9);
  if (rows.empty()) {
    canvas.text({40.0, kTop - 10.0}, "summary.json attributes nothing",
                {.colour = style::kSoftInk});
    return;
  }
  double sum = 0.0;
  double longest = 0.0;
  double names = 0.0;
  for (const Contribution& row : rows) {
    sum += row.us;
    longest = std::max(longest, row.us);
    names = std::max(names, canvas.text_width(name_of(row)));
  }
  const double left = 52.0 + std::clamp(names, 160.0, 330.0);
  double y = kTop;
  for (const Contribution& row : rows) {
    const double length = longest > 0.0 ? (kRight - left) * row.us / longest : 0.0;
    const double middle = y - 0.5 * kRow;
    canvas.text({left - 12.0, middle}, name_of(row), {.horizontal = Align::high});
    canvas.rectangle({left, middle - 12.0}, {left + std::max(length, 1.5), middle + 12.0},
                     colour_of(row.part));
    canvas.text({left + length + 10.0, middle},
                fmt::format("{:.1f} µs   {:.1f} %", row.us, sum > 0 ? 100 * row.us / sum : 0),
                {.colour = style::kInk});
    y -= kRow;
  }
  canvas.line({left, kTop + 2.0}, {left, y - 2.0}, style::kSoftInk, 1.4);
}

}  // namespace hvp::draw
