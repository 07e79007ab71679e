#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <vtkCamera.h>
#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkRenderer.h>

#include "app/draw/canvas.h"
#include "app/draw/deformation_scene.h"
#include "app/draw/picture_window.h"
#include "app/draw/pictures.h"
#include "app/draw/plot_data.h"

namespace hvp::draw {
namespace {

using Point = Canvas::Point;

// The part of the picture that the scene fills.
const Point kSceneLow(30.0, 80.0);
const Point kSceneHigh(1190.0, 890.0);

// The mapping of the scene's points to the picture.
struct Projection {
  View view;
  Point centre_m;
  double pixels_per_m = 1.0;

  Point at(const Eigen::Vector3d& x) const {
    const Point plane(view.right.dot(x), view.up.dot(x));
    return 0.5 * (kSceneLow + kSceneHigh) + pixels_per_m * (plane - centre_m);
  }
};

Projection fit(const DeformationStep& step, const SceneSizes& sizes) {
  Projection projection;
  projection.view = choose_view(step);
  std::vector<Eigen::Vector3d> shown = step.rest;
  for (std::size_t i = 0; i < step.rest.size(); ++i)
    shown.push_back(step.rest[i] + step.displacement[i]);
  for (const double side : {-sizes.probe_radius, sizes.probe_radius}) {
    shown.emplace_back(step.probe + side * projection.view.up);
    shown.emplace_back(step.probe + side * projection.view.right);
    for (const DeformationStep::Probe& probe : step.further_probes) {
      shown.emplace_back(probe.place + side * projection.view.up);
      shown.emplace_back(probe.place + side * projection.view.right);
      shown.push_back(arrow_tip(probe.place, probe.force_N, sizes));
    }
  }
  shown.push_back(sizes.arrow_tip);
  shown.push_back(step.tip);
  for (const DeformationStep::Probe& probe : step.further_probes) shown.push_back(probe.tip);
  const Extent extent = extent_in(projection.view, shown);
  projection.centre_m = extent.centre();
  const Point room = kSceneHigh - kSceneLow - Point(40.0, 40.0);
  const Point size = extent.size().cwiseMax(1e-12);
  projection.pixels_per_m = room.cwiseQuotient(size).minCoeff();
  return projection;
}

void place_camera(vtkRenderer& renderer, const Projection& projection, double body) {
  const View& view = projection.view;
  vtkCamera& camera = *renderer.GetActiveCamera();
  // The renderer fills the whole picture; its middle is not the middle of the scene's room.
  const Point middle = projection.centre_m + (Point(0.5 * kPictureWidth, 0.5 * kPictureHeight) -
                                              0.5 * (kSceneLow + kSceneHigh)) /
                                                 projection.pixels_per_m;
  const Eigen::Vector3d focus = middle.x() * view.right + middle.y() * view.up;
  const Eigen::Vector3d eye = focus + 10.0 * body * view.towards_viewer;
  camera.ParallelProjectionOn();
  camera.SetFocalPoint(focus.x(), focus.y(), focus.z());
  camera.SetPosition(eye.x(), eye.y(), eye.z());
  camera.SetViewUp(view.up.x(), view.up.y(), view.up.z());
  camera.SetParallelScale(0.5 * kPictureHeight / projection.pixels_per_m);
  renderer.ResetCameraClippingRange();
}

// A key light from the upper left and a weak one from the right, both moving with the camera.
void add_lights(vtkRenderer& renderer) {
  const auto add = [&](double x, double y, double z, double intensity) {
    vtkNew<vtkLight> light;
    light->SetLightTypeToCameraLight();
    light->SetPosition(x, y, z);
    light->SetIntensity(intensity);
    renderer.AddLight(light);
  };
  add(-0.5, 0.8, 1.0, 0.75);
  add(0.9, -0.3, 0.8, 0.40);
}

void draw_colour_scale(Canvas& canvas, const SceneSizes& sizes) {
  const Point low(1245.0, 190.0);
  const Point high(1275.0, 760.0);
  constexpr int kBands = 256;
  const double band = (high.y() - low.y()) / kBands;
  for (int i = 0; i < kBands; ++i)
    canvas.rectangle({low.x(), low.y() + i * band}, {high.x(), low.y() + (i + 1) * band},
                     sequential_colour(i / double(kBands - 1)));
  canvas.frame(low, high, style::kSoftInk, 1.2);
  const double range_mm = 1e3 * sizes.colour_range;
  const Ticks ticks = round_ticks(0.0, range_mm, 6);
  for (std::size_t i = 0; i < ticks.values.size(); ++i) {
    const double y = low.y() + (high.y() - low.y()) * ticks.values[i] / range_mm;
    canvas.line({high.x(), y}, {high.x() + 6.0, y}, style::kSoftInk, 1.2);
    canvas.text({high.x() + 12.0, y}, ticks.labels[i], {.size = 18});
  }
  canvas.text({low.x() - 6.0, high.y() + 48.0}, "displacement", {.size = 19});
  canvas.text({low.x() - 6.0, high.y() + 24.0}, "mm", {.size = 19});
}

// A bar of a round length; the projection is parallel, so that it is valid everywhere.
void draw_length_scale(Canvas& canvas, const Projection& projection) {
  const double wanted_mm = 1e3 * 75.0 / projection.pixels_per_m;
  const Ticks ticks = round_ticks(0.0, wanted_mm, 1);
  const double length = 1e-3 * ticks.step * projection.pixels_per_m;
  const Point right(1355.0, 62.0);
  const Point left = right - Point(length, 0.0);
  canvas.line(left, right, style::kInk, 2.0);
  for (const Point& end : {left, right})
    canvas.line(end - Point(0.0, 6.0), end + Point(0.0, 6.0), style::kInk, 2.0);
  canvas.text(0.5 * (left + right) - Point(0.0, 14.0), four_digits(ticks.step) + " mm",
              {.size = 18, .horizontal = Align::centre, .vertical = Align::high});
}

void draw_legend(Canvas& canvas, const DeformationStep& step, const SceneSizes& sizes) {
  constexpr double kY = 44.0;
  double x = 44.0;
  const auto label = [&](const std::string& words) {
    const TextStyle text = {.size = 18};
    canvas.text({x, kY}, words, text);
    x += canvas.text_width(words, text) + 38.0;
  };
  if (!step.anchors.empty()) {
    canvas.disc({x + 5.0, kY}, 5.0, scene_colour::kAnchor);
    x += 20.0;
    label(fmt::format("anchored node ({})", step.anchors.size()));
  }
  canvas.disc({x + 9.0, kY}, 9.0, scene_colour::kProbe);
  x += 28.0;
  label(sizes.probe_to_scale
            ? fmt::format("probe, radius {} mm", four_digits(1e3 * step.probe_radius))
            : "probe (drawn larger than it is)");
  if (step.force_N.norm() > 0.0) {
    canvas.line({x, kY}, {x + 22.0, kY}, scene_colour::kForce, 4.0);
    const Point tip[3] = {{x + 20.0, kY + 8.0}, {x + 20.0, kY - 8.0}, {x + 36.0, kY}};
    canvas.polygon(tip, scene_colour::kForce);
    x += 46.0;
    label("force on the probe");
  }
  if (step.probe != step.tip) {
    canvas.line({x, kY}, {x + 24.0, kY}, scene_colour::kGap, 1.5);
    canvas.disc({x + 24.0, kY}, 3.0, scene_colour::kGap);
    x += 36.0;
    label("gap to the device's tip");
  }
  canvas.line({x, kY}, {x + 30.0, kY}, scene_colour::kRest, 2.0);
  x += 40.0;
  label("shape at rest");
  if (!step.regions.empty()) {
    canvas.disc({x + 9.0, kY}, 9.0, faded(scene_colour::kRegion, 0.5));
    x += 28.0;
    label("region");
  }
}

// Puts a label beside the tip of an arrow that points up or down, and above a horizontal one.
void label_arrow(Canvas& canvas, const DeformationStep::Probe& probe, const SceneSizes& sizes,
                 const Projection& projection) {
  const Point tip = projection.at(arrow_tip(probe.place, probe.force_N, sizes));
  const Point along = tip - projection.at(probe.place);
  TextStyle text = {.size = 20, .colour = scene_colour::kForce, .bold = true};
  Point offset(16.0, along.y() < 0.0 ? 10.0 : -10.0);
  if (std::abs(along.x()) > std::abs(along.y())) {
    text.horizontal = Align::centre;
    offset = {0.0, 30.0};
  }
  const std::string words = four_digits(probe.force_N.norm()) + " N";
  // Keeps the label within the margins.
  const double half = 0.5 * canvas.text_width(words, text);
  Point at = tip + offset;
  at.x() = std::clamp(at.x(), kSceneLow.x() + half, kSceneHigh.x() - half);
  canvas.text(at, words, text);
}

// The way from a proxy to the device's tip, which is inside of the body.
void draw_gap(Canvas& canvas, const Eigen::Vector3d& place, const Eigen::Vector3d& tip,
              const Projection& projection) {
  if (place == tip) return;
  canvas.line(projection.at(place), projection.at(tip), scene_colour::kGap, 1.5);
  canvas.disc(projection.at(tip), 3.0, scene_colour::kGap);
}

void paint(Canvas& canvas, const DeformationStep& step, const SceneSizes& sizes,
           const Projection& projection, const Caption& caption) {
  const double force = step.force_N.norm();
  draw_caption(
      canvas, caption, fmt::format("Frame {}, t = {} s", step.frame, four_digits(step.time_s)),
      fmt::format("largest displacement {} mm · {}", four_digits(1e3 * sizes.max_displacement),
                  force > 0.0 ? fmt::format("contact force {} N", four_digits(force))
                              : std::string("no contact")));
  draw_gap(canvas, step.probe, step.tip, projection);
  for (const DeformationStep::Probe& probe : step.further_probes) {
    draw_gap(canvas, probe.place, probe.tip, projection);
  }
  if (force > 0.0) label_arrow(canvas, {step.probe, step.force_N, step.tip}, sizes, projection);
  for (const DeformationStep::Probe& probe : step.further_probes) {
    if (probe.force_N.norm() > 0.0) label_arrow(canvas, probe, sizes, projection);
  }
  draw_colour_scale(canvas, sizes);
  draw_length_scale(canvas, projection);
  draw_legend(canvas, step, sizes);
}

}  // namespace

void draw_deformation(PictureWindow& window, const DeformationStep& step, const Caption& caption) {
  const SceneSizes sizes = sizes_of(step);
  const Projection projection = fit(step, sizes);

  vtkNew<vtkRenderer> rest;
  rest->SetBackground(style::kPaper.red / 255.0, style::kPaper.green / 255.0,
                      style::kPaper.blue / 255.0);
  build_rest_shape(*rest, step, projection.view);
  place_camera(*rest, projection, sizes.body);
  window.add(*rest, 0);

  vtkNew<vtkRenderer> scene;
  build_scene(*scene, step, sizes);
  vtkNew<vtkRenderer> ghost;
  build_regions(*ghost, step);
  build_probe_ghost(*ghost, step, sizes);
  int layer = 1;
  for (vtkRenderer* renderer : {scene.Get(), ghost.Get()}) {
    renderer->AutomaticLightCreationOff();
    add_lights(*renderer);
    place_camera(*renderer, projection, sizes.body);
    window.add(*renderer, layer++);
  }

  vtkNew<vtkRenderer> labels;
  add_canvas(*labels, [&step, &caption, sizes, projection](Canvas& canvas) {
    paint(canvas, step, sizes, projection, caption);
  });
  window.add(*labels, layer);
}

}  // namespace hvp::draw
