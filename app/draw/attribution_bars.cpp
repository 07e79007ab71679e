#include "app/draw/attribution_bars.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/draw/canvas.h"

namespace hvp::draw {
namespace {

// Colours of the parts, after Okabe and Ito's palette for the colour-blind.
constexpr std::array<Colour, 6> kPartColours = {
    {{0, 114, 178}, {230, 159, 0}, {0, 158, 115}, {204, 121, 167}, {86, 180, 233}, {213, 94, 0}}};
constexpr Colour kOther = {160, 160, 155};

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
  std::vector<std::string> parts;  // in the order of their first row: a colour each
  double y = kTop;
  for (const Contribution& row : rows) {
    auto part = std::find(parts.begin(), parts.end(), row.part);
    if (part == parts.end()) part = parts.insert(parts.end(), row.part);
    const Colour colour =
        &row == &rows.back() && row.part == "other"
            ? kOther
            : kPartColours[static_cast<std::size_t>(part - parts.begin()) % kPartColours.size()];
    const double length = longest > 0.0 ? (kRight - left) * row.us / longest : 0.0;
    const double middle = y - 0.5 * kRow;
    canvas.text({left - 12.0, middle}, name_of(row), {.horizontal = Align::high});
    canvas.rectangle({left, middle - 12.0}, {left + std::max(length, 1.5), middle + 12.0}, colour);
    canvas.text({left + length + 10.0, middle},
                fmt::format("{:.1f} µs   {:.1f} %", row.us, sum > 0 ? 100 * row.us / sum : 0),
                {.colour = style::kInk});
    y -= kRow;
  }
  canvas.line({left, kTop + 2.0}, {left, y - 2.0}, style::kSoftInk, 1.4);
}

}  // namespace hvp::draw
