#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <vtkCell.h>
#include <vtkCellArray.h>
#include <vtkCellType.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkOutputWindow.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkTriangleFilter.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include "models/files/one_line.h"
#include "models/mesh/polygon_files.h"
#include "models/mesh/surface_check.h"
#include "models/mesh/surface_reader.h"

namespace hvp::mesh {

namespace {

// Keeps what VTK would have printed, errors only.
class CapturingWindow : public vtkOutputWindow {
 public:
  static CapturingWindow* New() {
    auto* window = new CapturingWindow;
    window->InitializeObjectBase();
    return window;
  }
  void DisplayText(const char* /*text*/) override {}
  void DisplayErrorText(const char* text) override { add(text); }
  void DisplayWarningText(const char* /*text*/) override {}
  void DisplayGenericWarningText(const char* /*text*/) override {}
  void DisplayDebugText(const char* /*text*/) override {}

  const std::string& first_error() const { return first_error_; }
  bool failed() const { return failed_; }

 private:
  // "ERROR: In file.cxx, line 12\nvtkSTLReader (0x55…): what happened\n\n"
  void add(const char* text) {
    failed_ = true;
    if (!first_error_.empty()) return;
    std::string_view message(text);
    const std::size_t object = message.find("): ");
    if (object != std::string_view::npos) message.remove_prefix(object + 3);
    for (const char c : message.substr(0, 200)) {
      const bool printable = c >= ' ' && c <= '~';
      if (printable) first_error_ += c;
      if (c == '\n') first_error_ += ' ';
    }
    while (!first_error_.empty() && first_error_.back() == ' ') first_error_.pop_back();
  }

  std::string first_error_;
  bool failed_ = false;
};

// The readers take whatever index the file names.
void check_indices(vtkIdList* ids, vtkIdType points) {
  for (vtkIdType k = 0; k < ids->GetNumberOfIds(); ++k) {
    if (ids->GetId(k) < 0 || ids->GetId(k) >= points) {
      refuse(fmt::format("a face names point {} of {}", ids->GetId(k), points));
    }
  }
}

void check_indices(vtkCellArray* cells, vtkIdType points) {
  vtkNew<vtkIdList> ids;
  for (vtkIdType i = 0; i < cells->GetNumberOfCells(); ++i) {
    cells->GetCellAtId(i, ids);
    check_indices(ids, points);
  }
}

int corners_of(int cell_type) {
  switch (cell_type) {
    case VTK_TETRA:
      return 4;
    case VTK_PYRAMID:
      return 5;
    case VTK_WEDGE:
      return 6;
    case VTK_HEXAHEDRON:
    case VTK_VOXEL:
      return 8;
    default:
      return 0;
  }
}

// The faces that belong to one volume cell only or, in a grid without volume cells, its
// triangles, quadrilaterals and polygons.
void collect_faces(vtkUnstructuredGrid* grid, vtkCellArray* faces) {
  const vtkIdType points = grid->GetNumberOfPoints();
  std::map<std::vector<vtkIdType>, std::pair<int, std::vector<vtkIdType>>> uses;
  vtkNew<vtkCellArray> flat;
  vtkNew<vtkIdList> ids;
  for (vtkIdType i = 0; i < grid->GetNumberOfCells(); ++i) {
    const int type = grid->GetCellType(i);
    grid->GetCellPoints(i, ids);
    check_indices(ids, points);
    if (type == VTK_TRIANGLE || type == VTK_QUAD || type == VTK_POLYGON) {
      flat->InsertNextCell(ids);
      continue;
    }
    if (type == VTK_EMPTY_CELL || type == VTK_VERTEX || type == VTK_POLY_VERTEX ||
        type == VTK_LINE || type == VTK_POLY_LINE) {
      continue;
    }
    if (corners_of(type) == 0) {
      refuse(
          fmt::format("cells of VTK type {} are not read; expected linear cells (tetrahedra, "
                      "hexahedra, wedges, pyramids, triangles, quadrilaterals, polygons)",
                      type));
    }
    if (ids->GetNumberOfIds() != corners_of(type)) {
      refuse(fmt::format("a cell of VTK type {} has {} points; expected {}", type,
                         ids->GetNumberOfIds(), corners_of(type)));
    }
    vtkCell* cell = grid->GetCell(i);
    for (int f = 0; f < cell->GetNumberOfFaces(); ++f) {
      vtkCell* face = cell->GetFace(f);
      std::vector<vtkIdType> loop;
      loop.reserve(static_cast<std::size_t>(face->GetNumberOfPoints()));
      for (int k = 0; k < static_cast<int>(face->GetNumberOfPoints()); ++k)
        loop.push_back(face->GetPointId(k));
      // A voxel's faces are pixels, which count row by row instead of around.
      if (face->GetCellType() == VTK_PIXEL) std::swap(loop[2], loop[3]);
      std::vector<vtkIdType> key = loop;
      std::sort(key.begin(), key.end());
      auto& use = uses[key];
      ++use.first;
      use.second = loop;
    }
  }
  for (const auto& [key, use] : uses) {
    if (use.first == 1) {
      faces->InsertNextCell(static_cast<vtkIdType>(use.second.size()), use.second.data());
    }
  }
  if (uses.empty()) faces->ShallowCopy(flat);
}

template <class Reader>
vtkSmartPointer<typename std::remove_pointer_t<decltype(std::declval<Reader>().GetOutput())>>
output_of(Reader& reader, const std::string& path, const CapturingWindow& window) {
  reader.SetFileName(path.c_str());
  reader.Update();
  if (window.failed() || reader.GetErrorCode() != 0) {
    refuse(fmt::format("VTK's reader refuses the file: {}",
                       window.first_error().empty() ? "no reason given" : window.first_error()));
  }
  return reader.GetOutput();
}

vtkSmartPointer<vtkPolyData> poly_data(const Polygons& polygons) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const Eigen::Vector3d& x : polygons.points) points->InsertNextPoint(x.data());
  vtkNew<vtkCellArray> faces;
  for (const std::vector<int>& polygon : polygons.polygons) {
    faces->InsertNextCell(static_cast<int>(polygon.size()));
    for (const int corner : polygon) faces->InsertCellPoint(corner);
  }
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  surface->SetPoints(points);
  surface->SetPolys(faces);
  return surface;
}

vtkSmartPointer<vtkPolyData> read_faces(const std::string& path, std::string_view bytes,
                                        SurfaceFormat format, const CapturingWindow& window) {
  switch (format) {
    case SurfaceFormat::stl:
      return poly_data(read_stl(bytes));
    case SurfaceFormat::ply:
      return poly_data(read_ply(bytes));
    case SurfaceFormat::obj:
      return poly_data(read_obj(bytes));
    case SurfaceFormat::vtp: {
      vtkNew<vtkXMLPolyDataReader> reader;
      return output_of(*reader, path, window);
    }
    case SurfaceFormat::vtu:
      break;
  }
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  const auto grid = output_of(*reader, path, window);
  vtkNew<vtkCellArray> faces;
  collect_faces(grid, faces);
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  surface->SetPoints(grid->GetPoints());
  surface->SetPolys(faces);
  return surface;
}

void check_vtk_xml(std::string_view bytes, std::string_view type) {
  if (bytes.find("<VTKFile") == std::string_view::npos) {
    refuse("the file holds no <VTKFile>; expected VTK's XML format");
  }
  if (bytes.find("</VTKFile>") == std::string_view::npos) {
    refuse("the file ends without </VTKFile>; it is cut off");
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
      refuse(fmt::format("the file declares {} = {}; at most {} are read",
                         files::one_line(attribute.substr(0, equals), 40),
                         files::one_line(attribute.substr(digits), 24), 3 * kMostTriangles));
    }
  }
  if (bytes.find(fmt::format("<{}", type)) == std::string_view::npos) {
    refuse(fmt::format("the file holds no <{}>, which its extension promises", type));
  }
}

}  // namespace

void precheck(std::string_view bytes, SurfaceFormat format) {
  if (bytes.empty()) refuse("the file is empty");
  if (format == SurfaceFormat::vtp) check_vtk_xml(bytes, "PolyData");
  if (format == SurfaceFormat::vtu) check_vtk_xml(bytes, "UnstructuredGrid");
}

Surface read_contents(const std::string& path, std::string_view bytes, SurfaceFormat format,
                      double unit_m) {
  vtkNew<CapturingWindow> window;
  vtkOutputWindow::SetInstance(window);
  const vtkSmartPointer<vtkPolyData> faces = read_faces(path, bytes, format, *window);

  vtkPoints* points = faces->GetPoints();
  const vtkIdType point_count = points == nullptr ? 0 : points->GetNumberOfPoints();
  check_indices(faces->GetPolys(), point_count);
  check_indices(faces->GetStrips(), point_count);
  // Only the geometry is wanted, and attribute arrays may be shorter than they should be.
  vtkNew<vtkPolyData> bare;
  bare->SetPoints(points);
  bare->SetPolys(faces->GetPolys());
  bare->SetStrips(faces->GetStrips());
  vtkNew<vtkTriangleFilter> filter;
  filter->SetInputData(bare);
  filter->PassVertsOff();
  filter->PassLinesOff();
  filter->Update();
  vtkCellArray* triangles = filter->GetOutput()->GetPolys();
  if (triangles->GetNumberOfCells() == 0) refuse("the file holds no triangles");
  if (triangles->GetNumberOfCells() > kMostTriangles) {
    refuse(fmt::format("the file holds {} triangles; at most {} are read",
                       triangles->GetNumberOfCells(), kMostTriangles));
  }

  Surface surface;
  vtkIdType broken = 0;
  for (vtkIdType i = 0; i < point_count; ++i) {
    const double* x = points->GetPoint(i);
    surface.points.emplace_back(unit_m * x[0], unit_m * x[1], unit_m * x[2]);
    if (!surface.points.back().allFinite()) ++broken;
  }
  if (broken > 0) {
    refuse(
        fmt::format("{} of {} points have a coordinate that is not a finite number, or above the "
                    "3.4e38 of single precision",
                    broken, point_count));
  }
  vtkNew<vtkIdList> ids;
  for (vtkIdType i = 0; i < triangles->GetNumberOfCells(); ++i) {
    triangles->GetCellAtId(i, ids);
    if (ids->GetNumberOfIds() != 3) continue;
    check_indices(ids, point_count);
    surface.triangles.push_back({static_cast<int>(ids->GetId(0)), static_cast<int>(ids->GetId(1)),
                                 static_cast<int>(ids->GetId(2))});
  }
  return merge_points(surface, merging_distance(surface));
}

}  // namespace hvp::mesh
