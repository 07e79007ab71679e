#include "app/draw/caption.h"

#include <fmt/format.h>

#include "app/draw/canvas.h"
#include "app/draw/picture_window.h"

namespace hvp::draw {
namespace {

using Point = Canvas::Point;

constexpr double kMargin = 40.0;
constexpr Colour kHeld = {20, 122, 74};
constexpr Colour kReserved = {158, 96, 0};  // held, but for something

std::string cut_to(Canvas& canvas, std::string words, const TextStyle& style, double width) {
  if (canvas.text_width(words, style) <= width) return words;
  while (!words.empty() && canvas.text_width(words + "…", style) > width) {
    // A whole character: UTF-8's continuation bytes are 10xxxxxx.
    do {
      words.pop_back();
    } while (!words.empty() && (static_cast<unsigned char>(words.back()) & 0xC0U) == 0x80U);
  }
  return words + "…";
}

Colour colour_of(const Caption& caption) {
  if (!caption.held) return style::kLate;
  return caption.verdict == "PASS" ? kHeld : kReserved;
}

}  // namespace

void draw_caption(Canvas& canvas, const Caption& caption, const std::string& what,
                  const std::string& figures) {
  const double width = kPictureWidth - 2 * kMargin;
  const auto line = [&](double y, const std::string& words, const TextStyle& text) {
    canvas.text({kMargin, y}, cut_to(canvas, words, text, width), text);
  };
  line(970.0, caption.title.empty() ? what : what + ": " + caption.title,
       {.size = 26, .bold = true});
  line(939.0, figures, {.size = 19, .colour = style::kSoftInk});
  if (caption.verdict.empty()) return;
  line(912.0,
       caption.flags.empty()
           ? caption.verdict
           : fmt::format("{}: {}", caption.verdict, fmt::join(caption.flags, ", ")),
       {.size = 19, .colour = colour_of(caption), .bold = true});
}

}  // namespace hvp::draw
