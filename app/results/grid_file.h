#pragma once

#include <filesystem>
#include <span>

#include <vtkSmartPointer.h>

#include "models/mesh/tet_mesh.h"

class vtkDataArray;
class vtkUnstructuredGrid;

// Tetrahedra as VTK's XML unstructured grid. What stands here keeps the bytes of a file a
// function of the data alone: fixed index width, fixed compressor and level, no date, no path.
namespace hvp::results {

// Points (64-bit) and tetrahedra (32-bit indices) without arrays.
vtkSmartPointer<vtkUnstructuredGrid> grid_of(const mesh::TetMesh& mesh);

// An array of `components` a tuple, in double precision or rounded to single precision.
// The number of values is a multiple of `components`.
vtkSmartPointer<vtkDataArray> double_array(const char* name, int components,
                                           std::span<const double> values);
vtkSmartPointer<vtkDataArray> float_array(const char* name, int components,
                                          std::span<const double> values);

// Through a part file; throws std::runtime_error when the file cannot be written.
void write_grid(const std::filesystem::path& path, vtkUnstructuredGrid& grid);

}  // namespace hvp::results
