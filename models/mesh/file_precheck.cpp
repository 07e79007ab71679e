#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/mesh/surface_reader.h"

namespace hvp::mesh {

namespace {

// A message quotes the file, whose bytes need be no text: it stays one printable line.
[[noreturn]] void refuse_file(std::string message) {
  std::replace_if(
      message.begin(), message.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  throw InputError("surface", message);
}

std::string_view next_line(std::string_view& rest) {
  const std::size_t end = rest.find('\n');
  std::string_view line = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::vector<std::string_view> words(std::string_view line) {
  std::vector<std::string_view> result;
  while (true) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return result;
    line.remove_prefix(begin);
    const std::size_t end = line.find_first_of(" \t\r");
    result.push_back(line.substr(0, end));
    if (end == std::string_view::npos) return result;
    line.remove_prefix(end);
  }
}

void check_triangle_count(std::uint64_t count, std::string_view what) {
  if (count > kMostTriangles) {
    refuse_file(
        fmt::format("the file declares {} {}; at most {} are read", count, what, kMostTriangles));
  }
}

// The position of a word, given in small letters, in any case: SOLID is as good as solid.
std::size_t find_word(std::string_view bytes, std::string_view word, std::size_t from = 0) {
  const auto same = [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; };
  const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(std::min(from, bytes.size()));
  const auto found = std::search(begin, bytes.end(), word.begin(), word.end(), same);
  return found == bytes.end() ? std::string_view::npos
                              : static_cast<std::size_t>(found - bytes.begin());
}

// Binary STL: 80 bytes of comment, a count, 50 bytes a triangle.
SurfaceFormat check_stl(std::string_view bytes) {
  constexpr std::size_t kHeader = 84;
  constexpr std::size_t kTriangle = 50;
  std::optional<std::uint32_t> declared;
  if (bytes.size() >= kHeader) {
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + 80, sizeof count);
    declared = count;
    if (bytes.size() == kHeader + kTriangle * std::size_t{count}) {
      check_triangle_count(count, "triangles");
      if (count == 0) refuse_file("the file declares 0 triangles");
      return SurfaceFormat::stl_binary;
    }
  }
  if (find_word(bytes.substr(0, 5), "solid") == 0 && bytes.find('\0') == std::string_view::npos) {
    if (find_word(bytes, "endsolid") == std::string_view::npos) {
      refuse_file("the text STL file ends without \"endsolid\"; it is cut off");
    }
    std::size_t vertices = 0;
    for (std::size_t at = find_word(bytes, "vertex"); at != std::string_view::npos;
         at = find_word(bytes, "vertex", at + 6)) {
      ++vertices;
    }
    if (vertices == 0) refuse_file("the text STL file holds no triangles");
    if (vertices % 3 != 0) {
      refuse_file(fmt::format("the text STL file has {} vertices; expected three for each triangle",
                              vertices));
    }
    check_triangle_count(vertices / 3, "triangles");
    return SurfaceFormat::stl_text;
  }
  if (!declared) {
    refuse_file(
        fmt::format("the file is neither a text STL file (it does not start with \"solid\") "
                    "nor a binary one ({} bytes; its header alone has {})",
                    bytes.size(), kHeader));
  }
  refuse_file(
      fmt::format("the binary STL file declares {} triangles, which take {} bytes; it has {}",
                  *declared, kHeader + kTriangle * std::size_t{*declared}, bytes.size()));
}

// Size of a PLY scalar type by either of its names; 0 for a name that is none.
std::size_t ply_size(std::string_view type) {
  if (type == "char" || type == "uchar" || type == "int8" || type == "uint8") return 1;
  if (type == "short" || type == "ushort" || type == "int16" || type == "uint16") return 2;
  if (type == "int" || type == "uint" || type == "int32" || type == "uint32") return 4;
  if (type == "float" || type == "float32") return 4;
  if (type == "double" || type == "float64") return 8;
  return 0;
}

void check_ply(std::string_view bytes) {
  std::string_view rest = bytes;
  if (next_line(rest) != "ply") refuse_file("the file does not start with \"ply\"");
  bool binary = false;
  bool ended = false;
  std::uint64_t items = 0;    // lines that a text file needs at least
  std::uint64_t least = 0;    // bytes that a binary file needs at least
  std::uint64_t current = 0;  // items of the element whose properties are being read
  std::uint64_t vertices = 0;
  std::uint64_t faces = 0;
  while (!rest.empty() && !ended) {
    const auto line = words(next_line(rest));
    if (line.empty()) continue;
    if (line[0] == "end_header") {
      ended = true;
    } else if (line[0] == "format" && line.size() >= 2) {
      binary = line[1] != "ascii";
    } else if (line[0] == "element") {
      if (line.size() != 3) refuse_file("the PLY header has an element without a name or count");
      const auto [end, error] =
          std::from_chars(line[2].data(), line[2].data() + line[2].size(), current);
      if (error != std::errc{} || end != line[2].data() + line[2].size()) {
        refuse_file(fmt::format("the PLY header has an element count that is no number: \"{:.40}\"",
                                line[2]));
      }
      // Three vertices a triangle would be the most; the rest is not looked at.
      if (current > 3 * std::uint64_t{kMostTriangles}) {
        refuse_file(
            fmt::format("the PLY header declares {} items of \"{:.40}\"; at most {} are read",
                        current, line[1], 3 * std::uint64_t{kMostTriangles}));
      }
      if (line[1] == "vertex") vertices = current;
      if (line[1] == "face") faces = current;
      items += current;
    } else if (line[0] == "property" && line.size() >= 3) {
      const std::size_t size = ply_size(line[1] == "list" ? line[2] : line[1]);
      if (size == 0) refuse_file("the PLY header has a property of unknown type");
      least += size * current;
    }
  }
  if (!ended) refuse_file("the PLY header ends without \"end_header\"; the file is cut off");
  if (vertices == 0 || faces == 0) {
    refuse_file(fmt::format("the PLY file declares {} vertices and {} faces", vertices, faces));
  }
  check_triangle_count(faces, "faces");
  if (binary && rest.size() < least) {
    refuse_file(fmt::format("the PLY header declares items of {} bytes at least; {} follow it",
                            least, rest.size()));
  }
  if (!binary) {
    std::uint64_t lines = 0;
    while (!rest.empty()) lines += words(next_line(rest)).empty() ? 0 : 1;
    if (lines < items) {
      refuse_file(
          fmt::format("the PLY header declares {} items; {} lines follow it", items, lines));
    }
  }
}

bool is_finite_number(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc{} && end == word.data() + word.size() && std::isfinite(value);
}

void check_obj(std::string_view bytes) {
  if (bytes.find('\0') != std::string_view::npos)
    refuse_file("the OBJ file holds bytes that are no text");
  std::uint64_t vertices = 0;
  std::uint64_t faces = 0;
  std::uint64_t number = 0;
  std::string_view rest = bytes;
  while (!rest.empty()) {
    const auto line = words(next_line(rest));
    ++number;
    if (line.empty()) continue;
    if (line[0] == "v") {
      ++vertices;
      if (line.size() < 4)
        refuse_file(fmt::format("line {}: a vertex needs three coordinates", number));
      for (std::size_t i = 1; i < 4; ++i) {
        // VTK's reader takes what is no number for one.
        if (!is_finite_number(line[i])) {
          refuse_file(fmt::format("line {}: the coordinate \"{:.40}\" is not a finite number",
                                  number, line[i]));
        }
      }
    }
    if (line[0] != "f") continue;
    ++faces;
    if (line.size() < 4)
      refuse_file(fmt::format("line {}: a face needs three corners at least", number));
    for (std::size_t i = 1; i < line.size(); ++i) {
      if (line[i] == "\\") break;  // continued on the next line; VTK checks the rest
      std::int64_t index = 0;
      const auto [end, error] =
          std::from_chars(line[i].data(), line[i].data() + line[i].size(), index);
      if (error != std::errc{} || (end != line[i].data() + line[i].size() && *end != '/')) {
        refuse_file(fmt::format("line {}: a face with the corner \"{:.40}\"", number, line[i]));
      }
      const auto count = static_cast<std::int64_t>(vertices);
      if (index == 0 || index > count || index < -count) {
        refuse_file(fmt::format("line {}: a face with the vertex {} where {} stand before it",
                                number, index, vertices));
      }
    }
  }
  if (vertices == 0 || faces == 0) {
    refuse_file(fmt::format("the OBJ file holds {} vertices and {} faces", vertices, faces));
  }
  check_triangle_count(faces, "faces");
}

void check_vtk_xml(std::string_view bytes, std::string_view type) {
  if (bytes.find("<VTKFile") == std::string_view::npos) {
    refuse_file("the file holds no <VTKFile>; expected VTK's XML format");
  }
  if (bytes.find("</VTKFile>") == std::string_view::npos) {
    refuse_file("the file ends without </VTKFile>; it is cut off");
  }
  // NumberOfPoints, NumberOfPolys, NumberOfTuples, …: the readers allocate what these promise.
  constexpr std::string_view kCount = "NumberOf";
  for (std::size_t at = bytes.find(kCount); at != std::string_view::npos;
       at = bytes.find(kCount, at + 1)) {
    const std::string_view attribute = bytes.substr(at, 80);
    const std::size_t equals = attribute.find('=');
    const std::size_t digits = attribute.find_first_of("0123456789-+");
    if (equals == std::string_view::npos || digits == std::string_view::npos) continue;
    std::uint64_t count = 0;
    const auto [end, error] =
        std::from_chars(attribute.data() + digits, attribute.data() + attribute.size(), count);
    if (error != std::errc{} || count > 3 * std::uint64_t{kMostTriangles}) {
      refuse_file(fmt::format("the file declares {} = {:.24}; at most {} are read",
                              attribute.substr(0, equals), attribute.substr(digits),
                              3 * kMostTriangles));
    }
  }
  if (bytes.find(fmt::format("<{}", type)) == std::string_view::npos) {
    refuse_file(fmt::format("the file holds no <{}>, which its extension promises", type));
  }
}

}  // namespace

SurfaceFormat precheck(std::string_view extension, std::string_view bytes) {
  std::string lower(extension);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (lower != ".stl" && lower != ".ply" && lower != ".obj" && lower != ".vtp" && lower != ".vtu") {
    refuse_file(
        fmt::format("files ending in \"{}\" are not read; expected .stl, .ply, .obj, .vtp or "
                    ".vtu",
                    lower));
  }
  if (bytes.empty()) refuse_file("the file is empty");
  if (lower == ".stl") return check_stl(bytes);
  if (lower == ".ply") {
    check_ply(bytes);
    return SurfaceFormat::ply;
  }
  if (lower == ".obj") {
    check_obj(bytes);
    return SurfaceFormat::obj;
  }
  if (lower == ".vtp") {
    check_vtk_xml(bytes, "PolyData");
    return SurfaceFormat::vtp;
  }
  check_vtk_xml(bytes, "UnstructuredGrid");
  return SurfaceFormat::vtu;
}

}  // namespace hvp::mesh
