#include "app/draw/deformation_step.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <string_view>

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkDataArraySelection.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUtilities.h>

#include "app/draw/vtk_errors.h"
#include "models/config/input_error.h"

namespace hvp::draw {
namespace {

// VTK 9.1's reader does not survive an array of a type that it does not know. Our steps hold
// these; the data that follow the header are not text.
bool has_known_types_only(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string header{std::istreambuf_iterator<char>(file), {}};
  header.resize(std::min(header.find("<AppendedData"), header.size()));
  constexpr std::string_view kType = " type=\"";
  for (std::size_t at = header.find(kType); at != std::string::npos; at = header.find(kType, at)) {
    at += kType.size();
    const std::string type = header.substr(at, header.find('"', at) - at);
    if (type != "UnstructuredGrid" && type != "Float64" && type != "Float32" && type != "Int32" &&
        type != "Int64" && type != "UInt8")
      return false;
  }
  return true;
}

constexpr const char* kRegions = "region";

// Reads one file and names it in every error.
class StepFile {
 public:
  explicit StepFile(const std::filesystem::path& path) : name_(path.filename().string()) {
    if (!std::filesystem::is_regular_file(path)) throw InputError(name_ + ": no such file");
    VtkErrors::take();
    if (reader_->CanReadFile(path.c_str()) == 0 || VtkErrors::take())
      fail("not a VTK XML unstructured grid");
    if (!has_known_types_only(path)) fail("holds an array of unknown type");
    reader_->SetFileName(path.c_str());
    reader_->UpdateInformation();
    reader_->GetCellDataArraySelection()->DisableAllArrays();
    reader_->GetCellDataArraySelection()->EnableArray(kRegions);
  }

  void skip_point_arrays() { reader_->GetPointDataArraySelection()->DisableAllArrays(); }

  vtkUnstructuredGrid& grid() {
    reader_->Update();
    if (VtkErrors::take() || reader_->GetErrorCode() != 0) fail("damaged: VTK cannot read it");
    return *reader_->GetOutput();
  }

  // An array of the given number of components and tuples, all of them finite.
  vtkDataArray& array(vtkFieldData& data, const char* name, int components,
                      vtkIdType tuples) const {
    vtkDataArray* found = data.GetArray(name);
    if (found == nullptr) fail(fmt::format("has no array '{}'", name));
    if (found->GetNumberOfComponents() != components || found->GetNumberOfTuples() != tuples)
      fail(fmt::format("array '{}' has {} tuples of {}, expected {} of {}", name,
                       found->GetNumberOfTuples(), found->GetNumberOfComponents(), tuples,
                       components));
    for (vtkIdType i = 0; i < tuples; ++i)
      for (int c = 0; c < components; ++c)
        if (!std::isfinite(found->GetComponent(i, c)))
          fail(fmt::format("array '{}' holds {} at {}", name, found->GetComponent(i, c), i));
    return *found;
  }

  Eigen::Vector3d vector_field(vtkFieldData& data, const char* name) const {
    // VTK chooses how many tuples of one component a field array has.
    vtkDataArray* found = data.GetArray(name);
    if (found != nullptr && found->GetNumberOfComponents() == 1 && found->GetNumberOfTuples() == 3)
      found->SetNumberOfComponents(3);
    vtkDataArray& checked = array(data, name, 3, 1);
    return Eigen::Vector3d(checked.GetComponent(0, 0), checked.GetComponent(0, 1),
                           checked.GetComponent(0, 2));
  }

  double scalar_field(vtkFieldData& data, const char* name) const {
    return array(data, name, 1, 1).GetComponent(0, 0);
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}: {}", name_, what));
  }

 private:
  std::string name_;
  vtkNew<vtkXMLUnstructuredGridReader> reader_;
};

// A ten-node tetrahedron as eight of four nodes: one at each corner, and the octahedron between
// them around its diagonal from the middle of edge 01 (node 4) to that of 23 (node 9). The nodes
// are numbered as VTK does.
constexpr std::array<std::array<std::size_t, 4>, 8> kPartsOfTenNodes{{{0, 4, 6, 7},
                                                                      {4, 1, 5, 8},
                                                                      {6, 5, 2, 9},
                                                                      {7, 8, 9, 3},
                                                                      {4, 9, 5, 6},
                                                                      {4, 9, 8, 5},
                                                                      {4, 9, 7, 8},
                                                                      {4, 9, 6, 7}}};

void read_tetrahedra(const StepFile& file, vtkUnstructuredGrid& grid, DeformationStep& step) {
  const auto nodes = static_cast<vtkIdType>(step.rest.size());
  vtkCellArray* cells = grid.GetCells();
  if (cells == nullptr || cells->GetNumberOfCells() == 0) file.fail("has no cells");
  vtkDataArray* offsets = cells->GetOffsetsArray();
  vtkDataArray* connectivity = cells->GetConnectivityArray();
  const vtkIdType count = cells->GetNumberOfCells();
  const bool quadratic = grid.GetCellType(0) == VTK_QUADRATIC_TETRA;
  const vtkIdType size = quadratic ? 10 : 4;
  if (connectivity->GetNumberOfTuples() != size * count)
    file.fail("has cells of other than 4 nodes, or of other than 10");
  for (vtkIdType e = 0; e < count; ++e) {
    if (grid.GetCellType(e) != (quadratic ? VTK_QUADRATIC_TETRA : VTK_TETRA) ||
        offsets->GetComponent(e, 0) != static_cast<double>(size * e))
      file.fail(fmt::format("cell {} is not a tetrahedron", e));
    std::array<int, 10> cell{};
    for (vtkIdType k = 0; k < size; ++k) {
      const double node = connectivity->GetComponent(size * e + k, 0);
      if (!(node >= 0.0 && node < static_cast<double>(nodes)))
        file.fail(fmt::format("cell {} names node {} of {}", e, node, nodes));
      cell[static_cast<std::size_t>(k)] = static_cast<int>(node);
    }
    if (!quadratic) {
      step.tetrahedra.push_back({cell[0], cell[1], cell[2], cell[3]});
      continue;
    }
    for (const auto& part : kPartsOfTenNodes)
      step.tetrahedra.push_back({cell[part[0]], cell[part[1]], cell[part[2]], cell[part[3]]});
  }
}

}  // namespace

std::vector<std::string> listed_steps(const std::filesystem::path& list) {
  const std::string name = list.filename().string();
  if (!std::filesystem::is_regular_file(list)) throw InputError(name + ": no such file");
  VtkErrors::take();
  const auto root =
      vtkSmartPointer<vtkXMLDataElement>::Take(vtkXMLUtilities::ReadElementFromFile(list.c_str()));
  if (root == nullptr || VtkErrors::take()) throw InputError(name + ": not well-formed XML");
  vtkXMLDataElement* collection = root->FindNestedElementWithName("Collection");
  if (collection == nullptr) throw InputError(name + ": has no <Collection>");
  std::vector<std::string> files;
  for (int i = 0; i < collection->GetNumberOfNestedElements(); ++i) {
    const char* file = collection->GetNestedElement(i)->GetAttribute("file");
    if (file == nullptr) throw InputError(fmt::format("{}: entry {} names no file", name, i + 1));
    files.emplace_back(file);
  }
  if (files.empty()) throw InputError(name + ": lists no step");
  return files;
}

double contact_force_of(const std::filesystem::path& path) {
  StepFile file(path);
  file.skip_point_arrays();
  return file.vector_field(*file.grid().GetFieldData(), "contact_force_N").norm();
}

DeformationStep read_step(const std::filesystem::path& path) {
  StepFile file(path);
  vtkUnstructuredGrid& grid = file.grid();
  const vtkIdType nodes = grid.GetNumberOfPoints();
  if (nodes == 0) file.fail("has no points");
  DeformationStep step;

  vtkDataArray& displacement = file.array(*grid.GetPointData(), "displacement", 3, nodes);
  vtkDataArray& anchor = file.array(*grid.GetPointData(), "anchor", 1, nodes);
  vtkDataArray& contact = file.array(*grid.GetPointData(), "contact", 1, nodes);
  for (vtkIdType i = 0; i < nodes; ++i) {
    step.rest.emplace_back(grid.GetPoint(i));
    if (!step.rest.back().allFinite()) file.fail(fmt::format("point {} is not finite", i));
    step.displacement.emplace_back(displacement.GetTuple3(i));
    if (anchor.GetComponent(i, 0) != 0.0) step.anchors.push_back(static_cast<int>(i));
    if (contact.GetComponent(i, 0) != 0.0) step.contact_node = static_cast<int>(i);
  }
  read_tetrahedra(file, grid, step);
  if (grid.GetCellData()->GetArray(kRegions) != nullptr) {
    const vtkIdType count = grid.GetNumberOfCells();
    const std::size_t parts = step.tetrahedra.size() / static_cast<std::size_t>(count);
    vtkDataArray& regions = file.array(*grid.GetCellData(), kRegions, 1, count);
    for (vtkIdType e = 0; e < count; ++e) {
      const double region = regions.GetComponent(e, 0);
      if (!(region >= 0.0 && region <= double(count)))
        file.fail(fmt::format("cell {} is of region {}", e, region));
      step.regions.insert(step.regions.end(), parts, static_cast<int>(region));
    }
  }

  vtkFieldData& fields = *grid.GetFieldData();
  step.time_s = file.scalar_field(fields, "time_s");
  step.frame = static_cast<int>(file.scalar_field(fields, "frame"));
  step.tip = file.vector_field(fields, "probe_position_m");
  // What stands on the surface is drawn there.
  const auto place = [&](const std::string& proxy, const Eigen::Vector3d& tip) {
    return fields.GetArray(proxy.c_str()) == nullptr ? tip
                                                     : file.vector_field(fields, proxy.c_str());
  };
  step.probe = place("proxy_position_m", step.tip);
  step.probe_radius = file.scalar_field(fields, "probe_radius_m");
  step.force_N = file.vector_field(fields, "contact_force_N");
  for (int i = 1;; ++i) {
    const std::string name = fmt::format("probe{}_position_m", i);
    if (fields.GetArray(name.c_str()) == nullptr) break;
    const std::string force = fmt::format("probe{}_contact_force_N", i);
    const Eigen::Vector3d tip = file.vector_field(fields, name.c_str());
    step.further_probes.push_back({place(fmt::format("probe{}_proxy_position_m", i), tip),
                                   file.vector_field(fields, force.c_str()), tip});
  }
  return step;
}

DeformationStep read_deepest_step(const std::filesystem::path& run_directory) {
  const std::vector<std::string> files = listed_steps(run_directory / "deformation.pvd");
  std::string deepest = files.back();
  double largest = 0.0;
  for (const std::string& file : files) {
    const double force = contact_force_of(run_directory / file);
    if (force > largest) {
      largest = force;
      deepest = file;
    }
  }
  return read_step(run_directory / deepest);
}

}  // namespace hvp::draw
