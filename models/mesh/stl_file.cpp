#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>

#include <fmt/format.h>

#include "models/mesh/polygon_files.h"
#include "models/mesh/polygon_text.h"

namespace hvp::mesh {

namespace {

constexpr std::size_t kStlHeader = 84;  // bytes: a comment of 80, and the count
constexpr std::size_t kStlTriangle = 50;

Polygons read_text_stl(std::string_view text) {
  Polygons result;
  Words words(text);
  bool ended = false;
  for (std::string_view word = words.anywhere(); !word.empty(); word = words.anywhere()) {
    if (is_word(word, "solid") || is_word(word, "endsolid")) {
      // The rest of the line, or all before the first facet, is the solid's name: any words.
      ended = is_word(word, "endsolid");
      for (word = words.in_line(); !word.empty() && !is_word(word, "facet");) {
        word = words.in_line();
      }
    } else if (is_word(word, "vertex")) {
      Eigen::Vector3d x;
      for (double& component : x) component = coordinate(words.in_line(), words.line());
      result.points.push_back(x);
    }
  }
  if (!ended) refuse("the text STL file ends without \"endsolid\"; it is cut off");
  if (result.points.empty()) refuse("the text STL file holds no triangles");
  if (result.points.size() % 3 != 0) {
    refuse(fmt::format("the text STL file has {} vertices; expected three for each triangle",
                       result.points.size()));
  }
  check_face_count(result.points.size() / 3, "triangles");
  for (int i = 0; i < static_cast<int>(result.points.size()); i += 3) {
    result.polygons.push_back({i, i + 1, i + 2});
  }
  return result;
}

Polygons read_binary_stl(std::string_view bytes, std::uint32_t count) {
  constexpr std::size_t kNormal = 12;
  check_face_count(count, "triangles");
  if (count == 0) refuse("the file declares 0 triangles");
  Polygons result;
  result.points.reserve(std::size_t{3} * count);
  for (std::size_t t = 0; t < count; ++t) {
    std::array<float, 9> values{};
    std::memcpy(values.data(), bytes.data() + kStlHeader + t * kStlTriangle + kNormal,
                sizeof(values));
    for (std::size_t k = 0; k < 9; k += 3) {
      result.points.emplace_back(values[k], values[k + 1], values[k + 2]);
    }
    const int first = static_cast<int>(3 * t);
    result.polygons.push_back({first, first + 1, first + 2});
  }
  return result;
}

}  // namespace

Polygons read_stl(std::string_view bytes) {
  std::optional<std::uint32_t> declared;
  if (bytes.size() >= kStlHeader) {
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + 80, sizeof count);
    declared = count;
    // A binary file may begin with "solid" too, and then has just that size.
    if (bytes.size() == kStlHeader + kStlTriangle * std::size_t{count}) {
      return read_binary_stl(bytes, count);
    }
  }
  const std::string_view text = text_of(bytes);
  if (is_word(Words(text).anywhere(), "solid") && text.find('\0') == std::string_view::npos) {
    return read_text_stl(text);
  }
  if (!declared) {
    refuse(
        fmt::format("the file is neither a text STL file (it does not start with \"solid\") "
                    "nor a binary one ({} bytes; its header alone has {})",
                    bytes.size(), kStlHeader));
  }
  // Some programs write something behind the last triangle.
  if (*declared > 0 && bytes.size() > kStlHeader + kStlTriangle * std::size_t{*declared}) {
    return read_binary_stl(bytes, *declared);
  }
  refuse(
      fmt::format("the file is no text STL file (it does not start with \"solid\", or holds "
                  "bytes that are no text), and as a binary one it declares {} triangles, which "
                  "take {} bytes; it has {}",
                  *declared, kStlHeader + kStlTriangle * std::size_t{*declared}, bytes.size()));
}

}  // namespace hvp::mesh
