#pragma once

#include <Eigen/Core>

#include "app/draw/colour_map.h"
#include "app/draw/deformation_step.h"
#include "app/draw/view.h"

class vtkRenderer;

namespace hvp::draw {

// Colours of the scene and its legend.
namespace scene_colour {
inline constexpr Colour kProbe = {74, 124, 142};
inline constexpr Colour kForce = {206, 62, 40};
inline constexpr Colour kAnchor = {28, 32, 38};
inline constexpr Colour kRest = {120, 126, 134};
inline constexpr Colour kRestFill = {228, 229, 228};
inline constexpr Colour kGap = {28, 32, 38};
inline constexpr Colour kRegion = {122, 52, 148};
}  // namespace scene_colour

// Sizes (m) that the scene and its labels share.
struct SceneSizes {
  double body = 0.0;          // diagonal of the rest shape's bounding box
  double probe_radius = 0.0;  // as drawn: never too small to be seen
  bool probe_to_scale = true;
  double max_displacement = 0.0;
  double colour_range = 0.0;  // displacement at the dark end of the map; positive
  Eigen::Vector3d arrow_tip;  // the probe's centre where there is no force
};
SceneSizes sizes_of(const DeformationStep& step);

// The end of the arrow of a force on a probe; the probe's centre where there is no force.
Eigen::Vector3d arrow_tip(const Eigen::Vector3d& probe, const Eigen::Vector3d& force_N,
                          const SceneSizes& sizes);

// Adds the deformed body coloured by displacement with its mesh, the probe, the anchored nodes and
// the force on the probe. The caller sets the renderer's camera and lights.
void build_scene(vtkRenderer& renderer, const DeformationStep& step, const SceneSizes& sizes);

// Adds a translucent copy of the probe and the arrow. In a layer above the scene it shows them
// where the body hides them.
void build_probe_ghost(vtkRenderer& renderer, const DeformationStep& step, const SceneSizes& sizes);

// Adds each region where the body has taken it, translucent, for a layer above the scene: most of a
// region is inside the body.
void build_regions(vtkRenderer& renderer, const DeformationStep& step);

// Adds the rest shape, flat with its outline as seen in `view`. It belongs into a layer below the
// scene: where nothing moved the two surfaces coincide, and only the rest shape's parts outside the
// body are visible.
void build_rest_shape(vtkRenderer& renderer, const DeformationStep& step, const View& view);

}  // namespace hvp::draw
