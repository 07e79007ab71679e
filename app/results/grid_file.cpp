#include "app/results/grid_file.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkTypeInt32Array.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridWriter.h>
#include <vtkZLibDataCompressor.h>

#include "app/results/part_file.h"

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

}  // namespace

vtkSmartPointer<vtkUnstructuredGrid> grid_of(const mesh::TetMesh& mesh) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(mesh.nodes.size()));
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    points->SetPoint(static_cast<vtkIdType>(i), mesh.nodes[i].data());

  vtkNew<vtkTypeInt32Array> offsets;
  vtkNew<vtkTypeInt32Array> connectivity;
  offsets->SetNumberOfValues(static_cast<vtkIdType>(mesh.tetrahedra.size()) + 1);
  connectivity->SetNumberOfValues(static_cast<vtkIdType>(4 * mesh.tetrahedra.size()));
  vtkIdType next = 0;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    offsets->SetValue(static_cast<vtkIdType>(e), static_cast<int>(next));
    for (const int node : mesh.tetrahedra[e]) connectivity->SetValue(next++, node);
  }
  offsets->SetValue(static_cast<vtkIdType>(mesh.tetrahedra.size()), static_cast<int>(next));
  vtkNew<vtkCellArray> cells;
  cells->SetData(offsets, connectivity);

  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  grid->SetPoints(points);
  grid->SetCells(VTK_TETRA, cells);
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

}  // namespace hvp::results
