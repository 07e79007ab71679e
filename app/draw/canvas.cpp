#include "app/draw/canvas.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <vtkBrush.h>
#include <vtkContext2D.h>
#include <vtkContextActor.h>
#include <vtkContextItem.h>
#include <vtkContextScene.h>
#include <vtkMarkerUtilities.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPen.h>
#include <vtkRenderer.h>
#include <vtkTextProperty.h>

#include "app/draw/picture_window.h"
#include "app/draw/plot_data.h"
#include "app/draw/run_files.h"

namespace hvp::draw {

namespace {

// Lengths in dashed lines.
constexpr double kDash = 9.0;
constexpr double kGap = 6.0;

class PaintedItem : public vtkContextItem {
 public:
  static PaintedItem* New();

  void set_paint(std::function<void(Canvas&)> paint) { paint_ = std::move(paint); }

  bool Paint(vtkContext2D* painter) override {
    Canvas canvas(*painter);
    paint_(canvas);
    return true;
  }

 private:
  std::function<void(Canvas&)> paint_;
};
vtkStandardNewMacro(PaintedItem)

    float scaled(double pixels) {
  return static_cast<float>(pixels * kSupersampling);
}

void set_fill(vtkContext2D& context, Colour fill) {
  context.GetPen()->SetLineType(vtkPen::NO_PEN);
  context.GetBrush()->SetColor(fill.red, fill.green, fill.blue, fill.alpha);
}

int justification(Align align) {
  switch (align) {
    case Align::low:
      return VTK_TEXT_LEFT;
    case Align::centre:
      return VTK_TEXT_CENTERED;
    case Align::high:
      return VTK_TEXT_RIGHT;
  }
  return VTK_TEXT_LEFT;
}

void set_text(vtkContext2D& context, const TextStyle& style) {
  vtkTextProperty& text = *context.GetTextProp();
  text.SetFontFamilyToArial();
  text.SetFontSize(static_cast<int>(std::lround(scaled(style.size))));
  text.SetBold(style.bold ? 1 : 0);
  text.SetColor(style.colour.red / 255.0, style.colour.green / 255.0, style.colour.blue / 255.0);
  text.SetOpacity(style.colour.alpha / 255.0);
  text.SetOrientation(style.angle_deg);
  text.SetJustification(justification(style.horizontal));
  text.SetVerticalJustification(style.vertical == Align::low      ? VTK_TEXT_BOTTOM
                                : style.vertical == Align::centre ? VTK_TEXT_CENTERED
                                                                  : VTK_TEXT_TOP);
}

}  // namespace

void Canvas::text(const Point& at, const std::string& words, const TextStyle& style) {
  set_text(context_, style);
  context_.DrawString(scaled(at.x()), scaled(at.y()), words.c_str());
}

double Canvas::text_width(const std::string& words, const TextStyle& style) {
  TextStyle upright = style;
  upright.angle_deg = 0.0;
  set_text(context_, upright);
  float bounds[4] = {0.0f, 0.0f, 0.0f, 0.0f};
  context_.ComputeStringBounds(words.c_str(), bounds);
  return static_cast<double>(bounds[2]) / kSupersampling;
}

void Canvas::polygon(std::span<const Point> corners, Colour fill) {
  set_fill(context_, fill);
  std::vector<float> xy;
  for (const Point& p : corners) xy.insert(xy.end(), {scaled(p.x()), scaled(p.y())});
  context_.DrawPolygon(xy.data(), static_cast<int>(corners.size()));
}

// OpenGL need not draw lines wider than a pixel, so a line is a thin rectangle.
void Canvas::line(const Point& from, const Point& to, Colour colour, double width) {
  const Point along = (to - from).normalized();
  const Point side = Point(-along.y(), along.x()) * (0.5 * width);
  const Point corners[4] = {from + side, from - side, to - side, to + side};
  polygon(corners, colour);
}

void Canvas::dashed_line(const Point& from, const Point& to, Colour colour, double width) {
  const double length = (to - from).norm();
  const Point along = (to - from).normalized();
  const int dashes = static_cast<int>(std::ceil(length / (kDash + kGap)));
  for (int i = 0; i < dashes; ++i) {
    const double s = i * (kDash + kGap);
    line(from + s * along, from + std::min(s + kDash, length) * along, colour, width);
  }
}

// One strip of quadrilaterals, since thousands of single polygons take seconds; the strip also
// fills the corners between segments.
void Canvas::polyline(std::span<const Point> points, Colour colour, double width) {
  if (points.size() == 1) disc(points.front(), width, colour);
  if (points.size() < 2) return;
  set_fill(context_, colour);
  std::vector<float> xy;
  xy.reserve(8 * points.size());
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Point along = (points[i] - points[i - 1]).normalized();
    const Point side = Point(-along.y(), along.x()) * (0.5 * width);
    for (const Point& end : {points[i - 1], points[i]})
      for (const Point& corner : {Point(end + side), Point(end - side)})
        xy.insert(xy.end(), {scaled(corner.x()), scaled(corner.y())});
  }
  context_.DrawQuadStrip(xy.data(), static_cast<int>(xy.size() / 2));
}

void Canvas::dashed_polyline(std::span<const Point> points, Colour colour, double width) {
  if (points.size() == 1) polyline(points, colour, width);
  bool dash = true;
  double left = kDash;  // of the current dash or gap
  std::vector<Point> stroke;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double length = (points[i] - points[i - 1]).norm();
    const Point along = (points[i] - points[i - 1]).normalized();
    if (dash) stroke.push_back(points[i - 1]);
    for (double at = 0.0; at < length;) {
      const double step = std::min(left, length - at);
      at += step;
      left -= step;
      if (dash) stroke.push_back(points[i - 1] + at * along);
      if (left > 0.0) continue;
      if (dash) polyline(stroke, colour, width);
      stroke.clear();
      dash = !dash;
      left = dash ? kDash : kGap;
      if (dash) stroke.push_back(points[i - 1] + at * along);
    }
  }
  polyline(stroke, colour, width);
}

void Canvas::rectangle(const Point& low, const Point& high, Colour fill) {
  const Point corners[4] = {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
  polygon(corners, fill);
}

void Canvas::frame(const Point& low, const Point& high, Colour colour, double width) {
  const double half = 0.5 * width;
  const Point low_right(high.x(), low.y());
  const Point high_left(low.x(), high.y());
  line(low - Point(half, 0), low_right + Point(half, 0), colour, width);
  line(high_left - Point(half, 0), high + Point(half, 0), colour, width);
  line(low, high_left, colour, width);
  line(low_right, high, colour, width);
}

void Canvas::disc(const Point& centre, double radius, Colour fill) {
  ring(centre, 0.5 * radius, fill, radius);
}

void Canvas::ring(const Point& centre, double radius, Colour colour, double width) {
  set_fill(context_, colour);
  const float outer = scaled(radius + 0.5 * width);
  const float inner = scaled(radius - 0.5 * width);
  context_.DrawEllipseWedge(scaled(centre.x()), scaled(centre.y()), outer, outer, inner, inner,
                            0.0f, 360.0f);
}

void Canvas::dots(std::span<const Point> centres, double radius, Colour fill) {
  if (centres.empty()) return;
  context_.GetPen()->SetLineType(vtkPen::SOLID_LINE);
  context_.GetPen()->SetColor(fill.red, fill.green, fill.blue, fill.alpha);
  context_.GetPen()->SetWidth(scaled(2.0 * radius));
  context_.GetBrush()->SetColor(fill.red, fill.green, fill.blue, fill.alpha);
  std::vector<float> xy;
  xy.reserve(2 * centres.size());
  for (const Point& p : centres) xy.insert(xy.end(), {scaled(p.x()), scaled(p.y())});
  context_.DrawMarkers(vtkMarkerUtilities::CIRCLE, false, xy.data(),
                       static_cast<int>(centres.size()));
}

void add_canvas(vtkRenderer& renderer, std::function<void(Canvas&)> paint) {
  vtkNew<PaintedItem> item;
  item->set_paint(std::move(paint));
  vtkNew<vtkContextActor> actor;
  actor->GetScene()->AddItem(item);
  renderer.AddActor(actor);
}

void add_page(PictureWindow& window, std::function<void(Canvas&)> paint) {
  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(style::kPaper.red / 255.0, style::kPaper.green / 255.0,
                          style::kPaper.blue / 255.0);
  add_canvas(*renderer, std::move(paint));
  window.add(*renderer, 0);
}

using Point = Canvas::Point;

void draw_y_axis(Canvas& canvas, const Axes& axes, int wanted_ticks) {
  const Ticks y = round_ticks(axes.data_low.y(), axes.data_high.y(), wanted_ticks);
  for (std::size_t i = 0; i < y.values.size(); ++i) {
    const Point p = axes.at(axes.data_low.x(), y.values[i]);
    canvas.line(p, {axes.high.x(), p.y()}, style::kGrid, 1.0);
    canvas.text(p - Point(10.0, 0.0), y.labels[i],
                {.size = 18, .colour = style::kSoftInk, .horizontal = Align::high});
  }
  canvas.line(axes.low, {axes.high.x(), axes.low.y()}, style::kSoftInk, 1.4);
  canvas.line(axes.low, {axes.low.x(), axes.high.y()}, style::kSoftInk, 1.4);
}

void draw_x_axis(Canvas& canvas, const Axes& axes, const Ticks& ticks, const std::string& label) {
  for (std::size_t i = 0; i < ticks.values.size(); ++i) {
    const Point p = axes.at(ticks.values[i], axes.data_low.y());
    canvas.line(p, p - Point(0.0, 6.0), style::kSoftInk, 1.2);
    canvas.text(p - Point(0.0, 11.0), ticks.labels[i],
                {.size = 18,
                 .colour = style::kSoftInk,
                 .horizontal = Align::centre,
                 .vertical = Align::high});
  }
  canvas.text({0.5 * (axes.low.x() + axes.high.x()), axes.low.y() - 52.0}, label,
              {.size = 19, .horizontal = Align::centre});
}

Point Legend::entry(const std::string& words) {
  const TextStyle text = {.size = 18, .horizontal = Align::high};
  canvas_.text(next_, words, text);
  next_.x() -= canvas_.text_width(words, text) + 18.0;
  Point sign = next_;
  next_.x() -= 30.0;
  return sign;
}

namespace {

using Point = Canvas::Point;

constexpr double kMargin = 40.0;
constexpr Colour kHeld = {20, 122, 74};
constexpr Colour kReserved = {158, 96, 0};  // the budgets are met, with reservations

std::string cut_to(Canvas& canvas, std::string words, const TextStyle& style, double width) {
  if (canvas.text_width(words, style) <= width) return words;
  while (!words.empty() && canvas.text_width(words + "…", style) > width) {
    // Removes a whole character: UTF-8's continuation bytes are 10xxxxxx.
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
