#include "app/draw/deformation_scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <vtkActor.h>
#include <vtkArrowSource.h>
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkLookupTable.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkSphereSource.h>

#include "app/draw/picture_window.h"
#include "app/draw/view.h"

namespace hvp::draw {
namespace {

using Eigen::Vector3d;

vtkSmartPointer<vtkPoints> points_of(std::span<const Vector3d> positions) {
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataTypeToDouble();
  for (const Vector3d& x : positions) points->InsertNextPoint(x.data());
  return points;
}

template <std::size_t N>
vtkSmartPointer<vtkCellArray> cells_of(std::span<const std::array<int, N>> nodes) {
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  for (const auto& cell : nodes) {
    cells->InsertNextCell(static_cast<int>(N));
    for (const int node : cell) cells->InsertCellPoint(node);
  }
  return cells;
}

vtkSmartPointer<vtkActor> add_actor(vtkRenderer& renderer, vtkPolyData* data, Colour colour) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  mapper->ScalarVisibilityOff();
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(colour.red / 255.0, colour.green / 255.0, colour.blue / 255.0);
  actor->GetProperty()->SetOpacity(colour.alpha / 255.0);
  renderer.AddActor(actor);
  return actor;
}

void soften(vtkProperty& property) {
  property.SetAmbient(0.50);
  property.SetDiffuse(0.58);
  property.SetSpecular(0.06);
  property.SetSpecularPower(24.0);
}

void add_body(vtkRenderer& renderer, const DeformationStep& step, const SceneSizes& sizes,
              vtkPoints* points, vtkCellArray* faces) {
  vtkNew<vtkDoubleArray> magnitude;
  for (const Vector3d& u : step.displacement) magnitude->InsertNextValue(u.norm());
  vtkNew<vtkPolyData> body;
  body->SetPoints(points);
  body->SetPolys(faces);
  body->GetPointData()->SetScalars(magnitude);

  vtkNew<vtkPolyDataNormals> normals;
  normals->SetInputData(body);
  normals->SetFeatureAngle(50.0);  // keeps a box's edges, rounds a coarse sphere
  normals->ConsistencyOff();
  normals->Update();

  vtkNew<vtkLookupTable> table;
  constexpr int kColours = 256;
  table->SetNumberOfTableValues(kColours);
  table->SetRange(0.0, sizes.colour_range);
  for (int i = 0; i < kColours; ++i) {
    const Colour c = sequential_colour(i / double(kColours - 1));
    table->SetTableValue(i, c.red / 255.0, c.green / 255.0, c.blue / 255.0, 1.0);
  }
  const auto actor = add_actor(renderer, normals->GetOutput(), {255, 255, 255});
  actor->GetMapper()->ScalarVisibilityOn();
  actor->GetMapper()->SetLookupTable(table);
  actor->GetMapper()->UseLookupTableScalarRangeOn();
  actor->GetMapper()->SetInterpolateScalarsBeforeMapping(1);
  actor->GetMapper()->SetRelativeCoincidentTopologyPolygonOffsetParameters(1.0, 1.0);
  soften(*actor->GetProperty());
}

void add_lines(vtkRenderer& renderer, vtkPoints* points, std::span<const std::array<int, 2>> lines,
               Colour colour, double width) {
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetLines(cells_of(lines));
  const auto actor = add_actor(renderer, data, colour);
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetLineWidth(static_cast<float>(width * kSupersampling));
}

void add_probe(vtkRenderer& renderer, const Vector3d& centre, double radius, double opacity) {
  vtkNew<vtkSphereSource> sphere;
  sphere->SetCenter(centre.x(), centre.y(), centre.z());
  sphere->SetRadius(radius);
  sphere->SetThetaResolution(48);
  sphere->SetPhiResolution(32);
  sphere->Update();
  const auto actor = add_actor(renderer, sphere->GetOutput(), faded(scene_colour::kProbe, opacity));
  actor->GetProperty()->BackfaceCullingOn();
  soften(*actor->GetProperty());
  actor->GetProperty()->SetSpecular(0.35);
}

void add_anchors(vtkRenderer& renderer, const DeformationStep& step,
                 std::span<const Vector3d> deformed) {
  if (step.anchors.empty()) return;
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> vertices;
  for (const int node : step.anchors) {
    const vtkIdType id = points->InsertNextPoint(deformed[static_cast<std::size_t>(node)].data());
    vertices->InsertNextCell(1, &id);
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetVerts(vertices);
  const auto actor = add_actor(renderer, data, scene_colour::kAnchor);
  actor->GetProperty()->SetRenderPointsAsSpheres(true);
  actor->GetProperty()->SetPointSize(9.0f * kSupersampling);
}

void add_arrow(vtkRenderer& renderer, const Vector3d& probe, const Vector3d& to,
               const SceneSizes& sizes, double opacity) {
  // The arrow starts at the probe's surface, or the ghost of its start would show inside the probe.
  const Vector3d from = probe + 0.98 * sizes.probe_radius * (to - probe).normalized();
  const double thickness = 0.007 * sizes.body;
  const double length = (to - from).norm();
  if (!(length > 0.0)) return;
  vtkNew<vtkArrowSource> arrow;
  arrow->SetShaftResolution(32);
  arrow->SetTipResolution(32);
  arrow->SetShaftRadius(thickness / length);
  arrow->SetTipRadius(2.6 * thickness / length);
  arrow->SetTipLength(7.0 * thickness / length);
  arrow->Update();
  // VTK's arrow reaches from the origin to (1, 0, 0).
  const Vector3d x = (to - from) / length;
  const Vector3d y = x.unitOrthogonal();
  const Vector3d z = x.cross(y);
  vtkNew<vtkMatrix4x4> pose;
  for (int row = 0; row < 3; ++row) {
    pose->SetElement(row, 0, length * x[row]);
    pose->SetElement(row, 1, length * y[row]);
    pose->SetElement(row, 2, length * z[row]);
    pose->SetElement(row, 3, from[row]);
  }
  const auto actor = add_actor(renderer, arrow->GetOutput(), faded(scene_colour::kForce, opacity));
  actor->GetProperty()->BackfaceCullingOn();
  actor->SetUserMatrix(pose);
  soften(*actor->GetProperty());
}

void add_further_probes(vtkRenderer& renderer, const DeformationStep& step, const SceneSizes& sizes,
                        double opacity) {
  for (const DeformationStep::Probe& probe : step.further_probes) {
    add_probe(renderer, probe.place, sizes.probe_radius, opacity);
    add_arrow(renderer, probe.place, arrow_tip(probe.place, probe.force_N, sizes), sizes, opacity);
  }
}

}  // namespace

SceneSizes sizes_of(const DeformationStep& step) {
  constexpr double kSmallestProbe = 0.012;  // of the body
  Vector3d low = step.rest.front();
  Vector3d high = low;
  SceneSizes sizes;
  for (std::size_t i = 0; i < step.rest.size(); ++i) {
    low = low.cwiseMin(step.rest[i]);
    high = high.cwiseMax(step.rest[i]);
    sizes.max_displacement = std::max(sizes.max_displacement, step.displacement[i].norm());
  }
  sizes.body = (high - low).norm();
  sizes.probe_radius = std::max(step.probe_radius, kSmallestProbe * sizes.body);
  sizes.probe_to_scale = sizes.probe_radius == step.probe_radius;
  sizes.colour_range = sizes.max_displacement > 0.0 ? sizes.max_displacement : 1e-3;
  sizes.arrow_tip = arrow_tip(step.probe, step.force_N, sizes);
  return sizes;
}

Vector3d arrow_tip(const Vector3d& probe, const Vector3d& force_N, const SceneSizes& sizes) {
  constexpr double kArrow = 0.16;  // of the body
  if (!(force_N.norm() > 0.0)) return probe;
  return probe + force_N.normalized() * (sizes.probe_radius + kArrow * sizes.body);
}

void build_regions(vtkRenderer& renderer, const DeformationStep& step) {
  constexpr double kOpacity = 0.35;
  if (step.regions.empty()) return;
  std::vector<Vector3d> deformed;
  for (std::size_t i = 0; i < step.rest.size(); ++i)
    deformed.push_back(step.rest[i] + step.displacement[i]);
  const auto points = points_of(deformed);
  const int last = *std::max_element(step.regions.begin(), step.regions.end());
  for (int region = 1; region <= last; ++region) {
    std::vector<std::array<int, 4>> own;
    for (std::size_t e = 0; e < step.tetrahedra.size(); ++e) {
      if (step.regions[e] == region) own.push_back(step.tetrahedra[e]);
    }
    const auto triangles = outer_faces(own);
    vtkNew<vtkPolyData> shell;
    shell->SetPoints(points);
    shell->SetPolys(cells_of(std::span<const std::array<int, 3>>(triangles)));
    const auto actor = add_actor(renderer, shell, faded(scene_colour::kRegion, kOpacity));
    actor->GetProperty()->BackfaceCullingOn();
    soften(*actor->GetProperty());
  }
}

void build_scene(vtkRenderer& renderer, const DeformationStep& step, const SceneSizes& sizes) {
  std::vector<Vector3d> deformed;
  for (std::size_t i = 0; i < step.rest.size(); ++i)
    deformed.push_back(step.rest[i] + step.displacement[i]);
  const auto triangles = outer_faces(step.tetrahedra);
  std::vector<std::array<int, 2>> mesh_lines;
  for (const Edge& edge : edges_of(triangles)) mesh_lines.push_back(edge.nodes);

  vtkMapper::SetResolveCoincidentTopologyToPolygonOffset();
  const auto points = points_of(deformed);
  add_body(renderer, step, sizes, points, cells_of(std::span<const std::array<int, 3>>(triangles)));
  add_lines(renderer, points, mesh_lines, {20, 20, 30, 70}, 1.0);
  add_anchors(renderer, step, deformed);
  add_probe(renderer, step.probe, sizes.probe_radius, 1.0);
  add_arrow(renderer, step.probe, sizes.arrow_tip, sizes, 1.0);
  add_further_probes(renderer, step, sizes, 1.0);
}

void build_probe_ghost(vtkRenderer& renderer, const DeformationStep& step,
                       const SceneSizes& sizes) {
  constexpr double kOpacity = 0.3;
  add_probe(renderer, step.probe, sizes.probe_radius, kOpacity);
  add_arrow(renderer, step.probe, sizes.arrow_tip, sizes, kOpacity);
  add_further_probes(renderer, step, sizes, kOpacity);
}

void build_rest_shape(vtkRenderer& renderer, const DeformationStep& step, const View& view) {
  const auto triangles = outer_faces(step.tetrahedra);
  const auto points = points_of(step.rest);
  vtkNew<vtkPolyData> rest;
  rest->SetPoints(points);
  rest->SetPolys(cells_of(std::span<const std::array<int, 3>>(triangles)));
  // Opaque in the colour that a translucent shape has on paper: below it is nothing but paper.
  const auto shell = add_actor(renderer, rest, scene_colour::kRestFill);
  shell->GetProperty()->LightingOff();
  const auto edges = edges_of(triangles);
  add_lines(renderer, points, outline(step.rest, triangles, edges, view.towards_viewer),
            scene_colour::kRest, 1.6);
}

}  // namespace hvp::draw
