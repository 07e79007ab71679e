#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "models/mesh/polygon_files.h"
#include "models/mesh/polygon_text.h"

namespace hvp::mesh {

namespace {

enum class PlyType { i8, u8, i16, u16, i32, u32, f32, f64 };

std::optional<PlyType> ply_type(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypes = {
      {{"char", PlyType::i8},
       {"int8", PlyType::i8},
       {"uchar", PlyType::u8},
       {"uint8", PlyType::u8},
       {"short", PlyType::i16},
       {"int16", PlyType::i16},
       {"ushort", PlyType::u16},
       {"uint16", PlyType::u16},
       {"int", PlyType::i32},
       {"int32", PlyType::i32},
       {"uint", PlyType::u32},
       {"uint32", PlyType::u32},
       {"float", PlyType::f32},
       {"float32", PlyType::f32},
       {"double", PlyType::f64},
       {"float64", PlyType::f64}}};
  for (const auto& [known, type] : kTypes) {
    if (known == name) return type;
  }
  return std::nullopt;
}

std::size_t size_of(PlyType type) {
  switch (type) {
    case PlyType::i8:
    case PlyType::u8:
      return 1;
    case PlyType::i16:
    case PlyType::u16:
      return 2;
    case PlyType::i32:
    case PlyType::u32:
    case PlyType::f32:
      return 4;
    case PlyType::f64:
      return 8;
  }
  return 0;
}

struct PlyProperty {
  std::string_view name;
  std::optional<PlyType> length;  // of a list: the type of its count
  PlyType type = PlyType::f32;
};

struct PlyElement {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  // The bytes, or words of a text, that an item takes at least.
  std::size_t least(bool binary) const {
    std::size_t sum = 0;
    for (const PlyProperty& p : properties) {
      sum += binary ? size_of(p.length.value_or(p.type)) : 1;
    }
    return sum;
  }
};

struct PlyHeader {
  bool binary = false;
  bool big_endian = false;
  std::vector<PlyElement> elements;
};

PlyElement ply_element(Words& words) {
  const std::string_view name = words.in_line();
  const std::string_view count = words.in_line();
  if (count.empty()) refuse("the PLY header has an element without a name or count");
  const auto items = whole<std::uint64_t>(count);
  if (!items) {
    refuse(
        fmt::format("the PLY header has an element count that is no number: \"{}\"", shown(count)));
  }
  // Three vertices a triangle would be the most; the rest is not looked at.
  if (*items > 3 * std::uint64_t{kMostTriangles}) {
    refuse(fmt::format("the PLY header declares {} items of \"{}\"; at most {} are read", *items,
                       shown(name), 3 * std::uint64_t{kMostTriangles}));
  }
  return {name, *items, {}};
}

PlyProperty ply_property(Words& words) {
  PlyProperty property;
  std::string_view type = words.in_line();
  if (type == "list") {
    property.length = ply_type(words.in_line());
    if (!property.length) refuse("the PLY header has a list whose count has no known type");
    type = words.in_line();
  }
  const std::optional<PlyType> known = ply_type(type);
  if (!known) refuse(fmt::format("the PLY header has the unknown type \"{}\"", shown(type)));
  property.type = *known;
  property.name = words.in_line();
  return property;
}

PlyHeader ply_header(Words& words) {
  if (words.in_line() != "ply") refuse("the file does not start with \"ply\"");
  PlyHeader header;
  while (words.next_line()) {
    const std::string_view what = words.in_line();
    if (what == "format") {
      const std::string_view format = words.in_line();
      header.binary = format != "ascii";
      header.big_endian = format == "binary_big_endian";
      if (header.binary && !header.big_endian && format != "binary_little_endian") {
        refuse(fmt::format("the PLY header has the unknown format \"{}\"", shown(format)));
      }
    } else if (what == "element") {
      header.elements.push_back(ply_element(words));
    } else if (what == "property") {
      if (header.elements.empty()) refuse("the PLY header has a property before any element");
      header.elements.back().properties.push_back(ply_property(words));
    } else if (what == "end_header") {
      // A file that ends here has no data, which is found out below.
      words.next_line();
      return header;
    }
  }
  refuse("the PLY header ends without \"end_header\"; the file is cut off");
}

// The numbers behind the header, in text or binary.
class PlyNumbers {
 public:
  PlyNumbers(const PlyHeader& header, const Words& words)
      : binary_(header.binary),
        swap_(header.big_endian == (std::endian::native == std::endian::little)),
        bytes_(words.rest()),
        words_(words) {}

  double number(PlyType type) {
    if (!binary_) {
      const std::string_view word = words_.anywhere();
      if (word.empty()) refuse("the PLY file is cut off: fewer numbers than its header declares");
      return coordinate_or_nan(word);
    }
    const std::size_t size = size_of(type);
    if (bytes_.size() < size) {
      refuse("the PLY file is cut off: fewer bytes than its header declares");
    }
    std::array<char, 8> raw{};
    std::memcpy(raw.data(), bytes_.data(), size);
    bytes_.remove_prefix(size);
    if (swap_) std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(size));
    return value(raw, type);
  }
  // A count or an index; refused where it is no whole number.
  std::int64_t integer(PlyType type) {
    const double value = number(type);
    if (std::abs(value) < 1e15 && value == std::floor(value)) {
      return static_cast<std::int64_t>(value);
    }
    refuse(place() + "expected a whole number in a list of the PLY file");
  }
  std::string place() const {
    return binary_ ? std::string() : fmt::format("line {}: ", words_.line());
  }

 private:
  double coordinate_or_nan(std::string_view word) const {
    if (word == "nan" || word == "-nan" || word == "inf" || word == "-inf") return std::nan("");
    return coordinate_of_double(word);
  }
  // Indices may have more digits than single precision.
  double coordinate_of_double(std::string_view word) const {
    if (const auto index = whole<std::int64_t>(word)) return static_cast<double>(*index);
    return coordinate(word, words_.line());
  }
  template <class Number>
  static double as(const std::array<char, 8>& raw) {
    Number value{};
    std::memcpy(&value, raw.data(), sizeof(value));
    return static_cast<double>(value);
  }
  static double value(const std::array<char, 8>& raw, PlyType type) {
    switch (type) {
      case PlyType::i8:
        return as<std::int8_t>(raw);
      case PlyType::u8:
        return as<std::uint8_t>(raw);
      case PlyType::i16:
        return as<std::int16_t>(raw);
      case PlyType::u16:
        return as<std::uint16_t>(raw);
      case PlyType::i32:
        return as<std::int32_t>(raw);
      case PlyType::u32:
        return as<std::uint32_t>(raw);
      case PlyType::f32:
        return as<float>(raw);
      case PlyType::f64:
        return as<double>(raw);
    }
    return 0;
  }

  bool binary_;
  bool swap_;
  std::string_view bytes_;
  Words words_;
};

void read_vertices(PlyNumbers& numbers, const PlyElement& element, Polygons& result) {
  constexpr std::array<std::string_view, 3> kAxes = {"x", "y", "z"};
  for (const std::string_view axis : kAxes) {
    const auto found = std::ranges::find(element.properties, axis, &PlyProperty::name);
    if (found == element.properties.end() || found->length) {
      refuse(fmt::format("the vertices of the PLY file have no \"{}\"", axis));
    }
  }
  for (std::uint64_t i = 0; i < element.count; ++i) {
    Eigen::Vector3d x;
    for (const PlyProperty& property : element.properties) {
      const std::int64_t items = property.length ? numbers.integer(*property.length) : 1;
      for (std::int64_t k = 0; k < items; ++k) {
        const double value = numbers.number(property.type);
        const auto axis = std::ranges::find(kAxes, property.name);
        if (axis != kAxes.end()) x[axis - kAxes.begin()] = single(value);
      }
    }
    result.points.push_back(x);
  }
}

void read_polygons(PlyNumbers& numbers, const PlyElement& element, std::uint64_t vertices,
                   Polygons& result) {
  for (std::uint64_t i = 0; i < element.count; ++i) {
    std::vector<int> polygon;
    for (const PlyProperty& property : element.properties) {
      const bool corners =
          property.length && (property.name == "vertex_indices" || property.name == "vertex_index");
      const std::int64_t items = property.length ? numbers.integer(*property.length) : 1;
      for (std::int64_t k = 0; k < items; ++k) {
        if (!corners) {
          numbers.number(property.type);
          continue;
        }
        const std::int64_t index = numbers.integer(property.type);
        if (index < 0 || static_cast<std::uint64_t>(index) >= vertices) {
          refuse(fmt::format("{}a face names point {} of {}", numbers.place(), index, vertices));
        }
        polygon.push_back(static_cast<int>(index));
      }
    }
    // A face of two corners is a line that somebody drew.
    if (polygon.size() >= 3) result.polygons.push_back(std::move(polygon));
  }
}

void skip(PlyNumbers& numbers, const PlyElement& element) {
  for (std::uint64_t i = 0; i < element.count; ++i) {
    for (const PlyProperty& property : element.properties) {
      const std::int64_t items = property.length ? numbers.integer(*property.length) : 1;
      for (std::int64_t k = 0; k < items; ++k) numbers.number(property.type);
    }
  }
}

}  // namespace

Polygons read_ply(std::string_view bytes) {
  Words words(without_byte_order_mark(bytes));
  const PlyHeader header = ply_header(words);
  std::uint64_t vertices = 0;
  std::uint64_t faces = 0;
  std::uint64_t least = 0;
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") vertices = element.count;
    if (element.name == "face") faces = element.count;
    least += element.count * element.least(header.binary);
  }
  if (vertices == 0 || faces == 0) {
    refuse(fmt::format("the PLY file declares {} vertices and {} faces", vertices, faces));
  }
  check_face_count(faces, "faces");
  // Words of a text are a blank apart, but for the last one.
  const std::uint64_t has = header.binary ? words.rest().size() : (words.rest().size() + 1) / 2;
  if (has < least) {
    refuse(fmt::format("the PLY header declares items of {} {} at least; {} bytes follow it", least,
                       header.binary ? "bytes" : "numbers", words.rest().size()));
  }
  Polygons result;
  PlyNumbers numbers(header, words);
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") {
      read_vertices(numbers, element, result);
    } else if (element.name == "face") {
      read_polygons(numbers, element, vertices, result);
    } else {
      skip(numbers, element);
    }
  }
  return result;
}

}  // namespace hvp::mesh
