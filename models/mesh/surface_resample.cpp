#include "models/mesh/surface_resample.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkQuadricDecimation.h>

#include "models/config/input_error.h"
#include "models/mesh/surface_check.h"

namespace hvp::mesh {

namespace {

using Edge = std::pair<int, int>;

constexpr double kVolumeTolerance = 0.05;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// Longest first; equal lengths in the order of their points.
struct LongerFirst {
  bool operator()(const std::pair<double, Edge>& a, const std::pair<double, Edge>& b) const {
    return a.first != b.first ? a.first > b.first : a.second < b.second;
  }
};

}  // namespace

Surface split_long_edges(const Surface& surface, double longest_edge) {
  Surface result = surface;
  std::map<Edge, std::set<int>> users;
  std::set<std::pair<double, Edge>, LongerFirst> queue;
  const double limit = longest_edge * longest_edge;
  const auto add_edge = [&](int a, int b, int triangle) {
    const Edge edge = std::minmax(a, b);
    users[edge].insert(triangle);
    const double length = (result.points[at(a)] - result.points[at(b)]).squaredNorm();
    if (length > limit) queue.emplace(length, edge);
  };
  for (std::size_t i = 0; i < result.triangles.size(); ++i) {
    const auto& t = result.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) add_edge(t[k], t[(k + 1) % 3], static_cast<int>(i));
  }
  while (!queue.empty()) {
    const Edge edge = queue.begin()->second;
    queue.erase(queue.begin());
    const int middle = static_cast<int>(result.points.size());
    result.points.emplace_back(0.5 *
                               (result.points[at(edge.first)] + result.points[at(edge.second)]));
    const std::set<int> split = std::exchange(users[edge], {});
    users.erase(edge);
    for (const int i : split) {
      // Turned so that the triangle reads (a, b, c) with the split edge from a to b.
      auto t = result.triangles[at(i)];
      while (std::minmax(t[0], t[1]) !=
             std::pair<const int&, const int&>(edge.first, edge.second)) {
        std::rotate(t.begin(), t.begin() + 1, t.end());
      }
      const int added = static_cast<int>(result.triangles.size());
      result.triangles[at(i)] = {t[0], middle, t[2]};
      result.triangles.push_back({middle, t[1], t[2]});
      users[std::minmax(t[1], t[2])].erase(i);
      add_edge(t[0], middle, i);
      add_edge(middle, t[2], i);
      add_edge(middle, t[1], added);
      add_edge(t[1], t[2], added);
      add_edge(t[2], middle, added);
    }
  }
  return result;
}

Surface decimate(const Surface& surface, int wanted_points) {
  vtkNew<vtkDoubleArray> coordinates;
  coordinates->SetNumberOfComponents(3);
  for (const auto& x : surface.points) coordinates->InsertNextTuple3(x.x(), x.y(), x.z());
  vtkNew<vtkPoints> points;
  points->SetData(coordinates);
  vtkNew<vtkCellArray> cells;
  for (const auto& t : surface.triangles) cells->InsertNextCell({t[0], t[1], t[2]});
  vtkNew<vtkPolyData> input;
  input->SetPoints(points);
  input->SetPolys(cells);

  // A closed surface of genus 0 has 2(points − 2) triangles.
  const double wanted_triangles = 2.0 * std::max(wanted_points - 2, 2);
  vtkNew<vtkQuadricDecimation> filter;
  filter->SetInputData(input);
  filter->VolumePreservationOn();
  filter->SetTargetReduction(
      std::clamp(1.0 - wanted_triangles / static_cast<double>(surface.triangles.size()), 0.0, 1.0));
  filter->Update();

  Surface coarse;
  vtkPolyData* output = filter->GetOutput();
  for (vtkIdType i = 0; i < output->GetNumberOfPoints(); ++i) {
    const double* x = output->GetPoint(i);
    coarse.points.emplace_back(x[0], x[1], x[2]);
  }
  vtkNew<vtkIdList> ids;
  for (vtkIdType i = 0; i < output->GetNumberOfCells(); ++i) {
    output->GetCellPoints(i, ids);
    if (ids->GetNumberOfIds() != 3) continue;
    coarse.triangles.push_back({static_cast<int>(ids->GetId(0)), static_cast<int>(ids->GetId(1)),
                                static_cast<int>(ids->GetId(2))});
  }
  try {
    coarse = check_surface(coarse);
  } catch (const InputError& error) {
    throw InputError("nodes", fmt::format("the surface has {} points and cannot be coarsened to "
                                          "{}: then {}",
                                          surface.points.size(), wanted_points, error.what()));
  }
  const double before = enclosed_volume(surface);
  const double after = enclosed_volume(coarse);
  if (std::abs(after - before) > kVolumeTolerance * before) {
    throw InputError(
        "nodes", fmt::format("the surface has {} points; coarsened to {} its volume would "
                             "change by {:.1f} % (at most {:.0f} % is accepted)",
                             surface.points.size(), coarse.points.size(),
                             100.0 * std::abs(after - before) / before, 100.0 * kVolumeTolerance));
  }
  return coarse;
}

}  // namespace hvp::mesh
