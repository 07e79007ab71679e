#include "app/results/vtu_files.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkTypeInt32Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridWriter.h>
#include <vtkZLibDataCompressor.h>

#include "app/results/part_files.h"

namespace hvp::results {

namespace {

template <class Array>
vtkSmartPointer<vtkDataArray> array_of(const char* name, int components,
                                       std::span<const double> values) {
  using Value = typename Array::ValueType;
  const auto array = vtkSmartPointer<Array>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()) / components);
  std::transform(values.begin(), values.end(), array->GetPointer(0),
                 [](double value) { return static_cast<Value>(value); });
  return array;
}

vtkSmartPointer<vtkUnstructuredGrid> grid_of(const mesh::TetMesh& mesh) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(mesh.nodes.size()));
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    points->SetPoint(static_cast<vtkIdType>(i), mesh.nodes[i].data());

  vtkNew<vtkTypeInt32Array> offsets;
  vtkNew<vtkTypeInt32Array> connectivity;
  offsets->SetNumberOfValues(static_cast<vtkIdType>(mesh.tetrahedra.size()) + 1);
  const std::size_t nodes_a_cell = mesh.quadratic() ? 10 : 4;
  connectivity->SetNumberOfValues(static_cast<vtkIdType>(nodes_a_cell * mesh.tetrahedra.size()));
  vtkIdType next = 0;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    offsets->SetValue(static_cast<vtkIdType>(e), static_cast<int>(next));
    for (const int node : mesh.tetrahedra[e]) connectivity->SetValue(next++, node);
    if (!mesh.quadratic()) continue;
    for (const int node : mesh.mid_edge[e]) connectivity->SetValue(next++, node);
  }
  offsets->SetValue(static_cast<vtkIdType>(mesh.tetrahedra.size()), static_cast<int>(next));
  vtkNew<vtkCellArray> cells;
  cells->SetData(offsets, connectivity);

  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  grid->SetPoints(points);
  grid->SetCells(mesh.quadratic() ? VTK_QUADRATIC_TETRA : VTK_TETRA, cells);
  return grid;
}

vtkSmartPointer<vtkDataArray> double_array(const char* name, int components,
                                           std::span<const double> values) {
  return array_of<vtkDoubleArray>(name, components, values);
}

vtkSmartPointer<vtkDataArray> float_array(const char* name, int components,
                                          std::span<const double> values) {
  return array_of<vtkFloatArray>(name, components, values);
}

void write_grid(const std::filesystem::path& path, vtkUnstructuredGrid& grid) {
  vtkNew<vtkZLibDataCompressor> compressor;
  compressor->SetCompressionLevel(1);  // mantissas hardly shrink at any level; this is the fastest
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  writer->SetInputData(&grid);
  writer->SetByteOrderToLittleEndian();
  writer->SetHeaderTypeToUInt32();
  writer->SetIdTypeToInt32();
  writer->SetCompressor(compressor);
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  writer->WriteToOutputStringOn();
  if (writer->Write() == 0)
    throw std::runtime_error(
        fmt::format("cannot write {}: VTK could not encode it", path.string()));
  write_through_part_file(path, writer->GetOutputString());
}

constexpr const char* kListName = "deformation.pvd";

bool is_step_name(std::string_view name) {
  constexpr std::string_view kPrefix = "deformation_";
  constexpr std::string_view kSuffix = ".vtu";
  if (name.ends_with(".part")) name.remove_suffix(5);
  if (!name.starts_with(kPrefix) || !name.ends_with(kSuffix)) return false;
  name.remove_prefix(kPrefix.size());
  name.remove_suffix(kSuffix.size());
  return name.size() >= 6 && std::all_of(name.begin(), name.end(),
                                         [](unsigned char c) { return std::isdigit(c) != 0; });
}

// A second run with fewer steps would otherwise leave the first one's beside its own.
void remove_earlier_steps(const std::filesystem::path& directory) {
  try {
    std::filesystem::remove(directory / kListName);
    std::vector<std::filesystem::path> old;
    for (const auto& entry : std::filesystem::directory_iterator(directory))
      if (is_step_name(entry.path().filename().string())) old.push_back(entry.path());
    for (const auto& path : old) std::filesystem::remove(path);
  } catch (const std::filesystem::filesystem_error& error) {
    throw std::runtime_error(fmt::format("cannot clear {} of an earlier run's steps: {}",
                                         directory.string(), error.code().message()));
  }
}

vtkSmartPointer<vtkUnsignedCharArray> node_marks(const char* name, std::size_t nodes,
                                                 std::span<const int> marked) {
  auto array = vtkSmartPointer<vtkUnsignedCharArray>::New();
  array->SetName(name);
  array->SetNumberOfValues(static_cast<vtkIdType>(nodes));
  array->FillValue(0);
  for (const int node : marked) {
    if (node < 0 || static_cast<std::size_t>(node) >= nodes)
      throw std::invalid_argument(
          fmt::format("{} node {} of a mesh with {} nodes", name, node, nodes));
    array->SetValue(node, 1);
  }
  return array;
}

void set_field(vtkUnstructuredGrid& grid, const char* name, std::span<const double> value) {
  grid.GetFieldData()->AddArray(double_array(name, static_cast<int>(value.size()), value));
}

void set_cell_array(vtkUnstructuredGrid& grid, const char* name, int components,
                    std::span<const double> values, std::size_t elements) {
  if (values.size() != elements * static_cast<std::size_t>(components))
    throw std::invalid_argument(fmt::format("{} has {} values for {} elements of {} components",
                                            name, values.size(), elements, components));
  const auto array = float_array(name, components, values);
  if (components == 6) {
    constexpr std::array<const char*, 6> kTensorNames = {"XX", "YY", "ZZ", "XY", "YZ", "XZ"};
    for (int c = 0; c < 6; ++c)
      array->SetComponentName(c, kTensorNames[static_cast<std::size_t>(c)]);
  }
  grid.GetCellData()->AddArray(array);
}

// Adds the number of each element's region, where there are any.
void set_regions(vtkUnstructuredGrid& grid, std::span<const int> regions, std::size_t elements) {
  if (regions.empty()) return;
  if (regions.size() != elements)
    throw std::invalid_argument(
        fmt::format("regions of {} elements for {}", regions.size(), elements));
  vtkNew<vtkTypeInt32Array> array;
  array->SetName("region");
  for (const int region : regions) array->InsertNextValue(region);
  grid.GetCellData()->AddArray(array);
}

}  // namespace

std::string step_file_name(int frame) { return fmt::format("deformation_{:06}.vtu", frame); }

DeformationWriter::DeformationWriter(std::filesystem::path directory, const mesh::TetMesh& mesh,
                                     std::span<const int> anchors, std::span<const int> regions)
    : directory_(std::move(directory)),
      nodes_(mesh.nodes.size()),
      elements_(mesh.tetrahedra.size()),
      grid_(grid_of(mesh)) {
  grid_->GetPointData()->AddArray(node_marks("anchor", nodes_, anchors));
  set_regions(*grid_, regions, elements_);
  remove_earlier_steps(directory_);
}

DeformationWriter::~DeformationWriter() = default;

void DeformationWriter::write(double time_s, int frame, std::span<const double> displacement_m,
                              const StepInfo& info) {
  if (displacement_m.size() != 3 * nodes_)
    throw std::invalid_argument(
        fmt::format("{} displacements for {} nodes", displacement_m.size(), nodes_));
  if (frame < 0 || (!steps_.empty() && frame <= steps_.back().frame))
    throw std::invalid_argument(fmt::format("step of frame {} after that of frame {}", frame,
                                            steps_.empty() ? -1 : steps_.back().frame));

  const auto displacement = double_array("displacement", 3, displacement_m);
  grid_->GetPointData()->SetVectors(displacement);
  grid_->GetPointData()->AddArray(node_marks("contact", nodes_, info.contact_nodes));
  set_cell_array(*grid_, "strain", 6, info.strain, elements_);
  set_cell_array(*grid_, "stress", 6, info.stress_Pa, elements_);
  set_cell_array(*grid_, "von_mises", 1, info.von_mises_Pa, elements_);

  set_field(*grid_, "time_s", {&time_s, 1});
  vtkNew<vtkIntArray> frame_field;
  frame_field->SetName("frame");
  frame_field->InsertNextValue(frame);
  grid_->GetFieldData()->AddArray(frame_field);
  set_field(*grid_, "probe_position_m", {info.probe_position_m.data(), 3});
  set_field(*grid_, "probe_radius_m", {&info.probe_radius_m, 1});
  set_field(*grid_, "contact_force_N", {info.contact_force_N.data(), 3});
  for (std::size_t i = 0; i < info.further_probes_m.size(); ++i) {
    set_field(*grid_, fmt::format("probe{}_position_m", i + 1).c_str(),
              {info.further_probes_m[i].data(), 3});
    set_field(*grid_, fmt::format("probe{}_contact_force_N", i + 1).c_str(),
              {info.further_forces_N[i].data(), 3});
  }
  for (std::size_t i = 0; i < info.proxies_m.size(); ++i) {
    const std::string probe = i == 0 ? "" : fmt::format("probe{}_", i);
    set_field(*grid_, (probe + "proxy_position_m").c_str(), {info.proxies_m[i].data(), 3});
  }

  write_grid(directory_ / step_file_name(frame), *grid_);
  steps_.push_back({time_s, frame});
}

void DeformationWriter::finish() {
  std::string list =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
      "  <Collection>\n";
  for (const Step& step : steps_)
    list += fmt::format("    <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", step.time_s,
                        step_file_name(step.frame));
  list += "  </Collection>\n</VTKFile>\n";
  write_through_part_file(directory_ / kListName, list);
}

void write_mesh(const std::filesystem::path& path, const mesh::TetMesh& mesh,
                const ElementQuality& quality) {
  const std::size_t elements = mesh.tetrahedra.size();
  if (quality.min_dihedral_angle_deg.size() != elements || quality.aspect_ratio.size() != elements)
    throw std::invalid_argument(
        fmt::format("{} dihedral angles and {} aspect ratios for {} tetrahedra",
                    quality.min_dihedral_angle_deg.size(), quality.aspect_ratio.size(), elements));
  const auto grid = grid_of(mesh);
  grid->GetCellData()->AddArray(
      double_array("min_dihedral_angle_deg", 1, quality.min_dihedral_angle_deg));
  grid->GetCellData()->AddArray(double_array("aspect_ratio", 1, quality.aspect_ratio));
  set_regions(*grid, quality.region, elements);
  write_grid(path, *grid);
}

}  // namespace hvp::results
