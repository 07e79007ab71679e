#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <string>

#include "app/draw/colour_map.h"

class vtkContext2D;
class vtkRenderer;

namespace hvp::draw {

class PictureWindow;

// The pictures' common look.
namespace style {
inline constexpr Colour kPaper = {250, 249, 246};
inline constexpr Colour kInk = {34, 38, 43};
inline constexpr Colour kSoftInk = {98, 104, 112};
inline constexpr Colour kGrid = {225, 225, 220};
inline constexpr Colour kLate = {196, 30, 46};
}  // namespace style

enum class Align { low, centre, high };  // left or bottom, centre, right or top

struct TextStyle {
  double size = 18.0;  // height of the font in picture pixels
  Colour colour = style::kInk;
  bool bold = false;
  Align horizontal = Align::low;
  Align vertical = Align::centre;
  double angle_deg = 0.0;  // anticlockwise
};

// Draws in picture pixels with the origin at the bottom left, y upwards. Text is UTF-8.
class Canvas {
 public:
  using Point = Eigen::Vector2d;

  explicit Canvas(vtkContext2D& context) : context_(context) {}

  void text(const Point& at, const std::string& words, const TextStyle& style = {});
  double text_width(const std::string& words, const TextStyle& style = {});
  void line(const Point& from, const Point& to, Colour colour, double width);
  void dashed_line(const Point& from, const Point& to, Colour colour, double width);
  // A line through all points; a single one is a dot.
  void polyline(std::span<const Point> points, Colour colour, double width);
  // Likewise, in dashes that go on around the corners.
  void dashed_polyline(std::span<const Point> points, Colour colour, double width);
  void rectangle(const Point& low, const Point& high, Colour fill);
  void frame(const Point& low, const Point& high, Colour colour, double width);
  void polygon(std::span<const Point> corners, Colour fill);
  void disc(const Point& centre, double radius, Colour fill);
  void ring(const Point& centre, double radius, Colour colour, double width);
  // Discs of one size and colour, many at a time.
  void dots(std::span<const Point> centres, double radius, Colour fill);

 private:
  vtkContext2D& context_;
};

// Makes `paint` draw over everything that the renderer shows, each time it renders.
void add_canvas(vtkRenderer& renderer, std::function<void(Canvas&)> paint);

// A picture that is nothing but what `paint` draws on the paper. What `paint` refers to is needed
// until the window has rendered.
void add_page(PictureWindow& window, std::function<void(Canvas&)> paint);

}  // namespace hvp::draw
