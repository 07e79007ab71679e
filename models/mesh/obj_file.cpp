#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "models/mesh/polygon_files.h"
#include "models/mesh/polygon_text.h"

namespace hvp::mesh {

namespace {

// A line without its comment, in whole where a backslash continues it.
class ObjLines {
 public:
  explicit ObjLines(std::string_view text) : rest_(text) {}

  bool next() {
    if (rest_.empty()) return false;
    line_ = next_line_;
    joined_.clear();
    while (!rest_.empty()) {
      const std::size_t end = std::min(rest_.find('\n'), rest_.size());
      std::string_view part = rest_.substr(0, end);
      rest_.remove_prefix(std::min(end + 1, rest_.size()));
      ++next_line_;
      part = part.substr(0, part.find('#'));
      while (!part.empty() && kBlanks.find(part.back()) != std::string_view::npos) {
        part.remove_suffix(1);
      }
      const bool continues = !part.empty() && part.back() == '\\';
      if (continues) part.remove_suffix(1);
      joined_ += part;
      if (!continues) break;
      joined_ += ' ';
    }
    return true;
  }
  std::string_view text() const { return joined_; }
  std::size_t number() const { return line_; }

 private:
  std::string_view rest_;
  std::string joined_;
  std::size_t line_ = 1;
  std::size_t next_line_ = 1;
};

// The vertex of a corner such as 7, 7/2, 7//3, -1/2/3 or 7/.
int corner_of(std::string_view word, std::size_t vertices, std::size_t line) {
  const std::optional<std::int64_t> index = whole<std::int64_t>(word.substr(0, word.find('/')));
  if (!index) refuse_line(line, fmt::format("a face with the corner \"{}\"", shown(word)));
  const auto count = static_cast<std::int64_t>(vertices);
  if (*index == 0 || *index > count || *index < -count) {
    refuse_line(
        line, fmt::format("a face with the vertex {} where {} stand before it", *index, vertices));
  }
  return static_cast<int>(*index > 0 ? *index - 1 : count + *index);
}

}  // namespace

Polygons read_obj(std::string_view bytes) {
  const std::string_view text = text_of(bytes);
  if (text.find('\0') != std::string_view::npos) {
    refuse("the OBJ file holds bytes that are no text");
  }
  Polygons result;
  for (ObjLines lines(text); lines.next();) {
    Words words(lines.text());
    const std::string_view what = words.in_line();
    if (what == "v") {
      Eigen::Vector3d x;
      for (double& component : x) {
        const std::string_view word = words.in_line();
        if (word.empty()) refuse_line(lines.number(), "a vertex needs three coordinates");
        component = coordinate(word, lines.number());
      }
      result.points.push_back(x);
    } else if (what == "f") {
      std::vector<int> polygon;
      for (std::string_view word = words.in_line(); !word.empty(); word = words.in_line()) {
        polygon.push_back(corner_of(word, result.points.size(), lines.number()));
      }
      if (polygon.size() < 3) refuse_line(lines.number(), "a face needs three corners at least");
      result.polygons.push_back(std::move(polygon));
    }
  }
  if (result.points.empty() || result.polygons.empty()) {
    refuse(fmt::format("the OBJ file holds {} vertices and {} faces", result.points.size(),
                       result.polygons.size()));
  }
  check_face_count(result.polygons.size(), "faces");
  return result;
}

std::string obj_text(const Surface& surface, double unit_m) {
  std::string text;
  for (const Eigen::Vector3d& x : surface.points) {
    const Eigen::Vector3f in_unit = (x / unit_m).cast<float>();
    text += fmt::format("v {} {} {}\n", in_unit[0], in_unit[1], in_unit[2]);
  }
  for (const auto& t : surface.triangles) {
    text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
  return text;
}

}  // namespace hvp::mesh
