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
struct Caption;
struct Ticks;

// The colours that all pictures share.
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
  // Draws a line through all points; a single point is a dot.
  void polyline(std::span<const Point> points, Colour colour, double width);
  // Draws the same line in dashes that continue around the corners.
  void dashed_polyline(std::span<const Point> points, Colour colour, double width);
  void rectangle(const Point& low, const Point& high, Colour fill);
  void frame(const Point& low, const Point& high, Colour colour, double width);
  void polygon(std::span<const Point> corners, Colour fill);
  void disc(const Point& centre, double radius, Colour fill);
  void ring(const Point& centre, double radius, Colour colour, double width);
  // Draws many discs of one size and colour.
  void dots(std::span<const Point> centres, double radius, Colour fill);

 private:
  vtkContext2D& context_;
};

// Makes `paint` draw over everything that the renderer shows, each time it renders.
void add_canvas(vtkRenderer& renderer, std::function<void(Canvas&)> paint);

// Adds a picture that `paint` alone draws on the paper. Objects to which `paint` refers must live
// until the window has rendered.
void add_page(PictureWindow& window, std::function<void(Canvas&)> paint);

// A mapping of data coordinates to a rectangle of the picture.
struct Axes {
  Canvas::Point low;
  Canvas::Point high;
  Canvas::Point data_low;
  Canvas::Point data_high;

  Canvas::Point at(double x, double y) const {
    const Canvas::Point share =
        (Canvas::Point(x, y) - data_low).cwiseQuotient(data_high - data_low);
    return low + share.cwiseProduct(high - low);
  }
};

// Draws both axes' lines, and about `wanted_ticks` ticks up the left side with lines across the
// plot.
void draw_y_axis(Canvas& canvas, const Axes& axes, int wanted_ticks);

// Draws the ticks below the plot, and the axis' label.
void draw_x_axis(Canvas& canvas, const Axes& axes, const Ticks& ticks, const std::string& label);

// The meaning of a plot's marks, in a line of text that grows to the left.
class Legend {
 public:
  Legend(Canvas& canvas, const Canvas::Point& right_end) : canvas_(canvas), next_(right_end) {}

  // Writes the words and returns the middle of the 24 pixels before them, where the mark goes.
  Canvas::Point entry(const std::string& words);

 private:
  Canvas& canvas_;
  Canvas::Point next_;  // the right end of the next entry
};

// Draws the head of a picture: its subject `what` and the run's title, a line of `figures`, and the
// run's verdict with its flags. Lines that are too long for the picture are cut.
void draw_caption(Canvas& canvas, const Caption& caption, const std::string& what,
                  const std::string& figures);

}  // namespace hvp::draw
