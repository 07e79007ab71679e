#pragma once

#include <Eigen/Core>

#include "app/draw/colour_map.h"
#include "app/draw/deformation_step.h"
#include "app/draw/view.h"

class vtkRenderer;

namespace hvp::draw {

// Colours of the scene, for its legend too.
namespace scene_colour {
inline constexpr Colour kProbe = {74, 124, 142};
inline constexpr Colour kForce = {206, 62, 40};
inline constexpr Colour kAnchor = {28, 32, 38};
inline constexpr Colour kRest = {120, 126, 134};
inline constexpr Colour kRestFill = {228, 229, 228};
}  // namespace scene_colour

// Sizes in metres that the scene and its labels share.
struct SceneSizes {
  double body = 0.0;          // diagonal of the rest shape's bounding box
  double probe_radius = 0.0;  // as drawn: never too small to see
  bool probe_to_scale = true;
  double max_displacement = 0.0;
  double colour_range = 0.0;  // displacement at the dark end of the map; positive
  Eigen::Vector3d arrow_tip;  // the probe's centre where there is no force
};
SceneSizes sizes_of(const DeformationStep& step);

// Where the arrow of a force on a probe ends; the probe's centre where there is no force.
Eigen::Vector3d arrow_tip(const Eigen::Vector3d& probe, const Eigen::Vector3d& force_N,
                          const SceneSizes& sizes);

// The deformed body coloured by displacement with its mesh, the probe, the anchored nodes and
// the force on the probe. The renderers' camera and lights are the caller's.
void build_scene(vtkRenderer& renderer, const DeformationStep& step, const SceneSizes& sizes);

// The probe and the arrow once more, translucent. In a layer above the scene they show through
// the body where it hides them.
void build_probe_ghost(vtkRenderer& renderer, const DeformationStep& step, const SceneSizes& sizes);

// The rest shape, flat with its outline as seen in `view`. It belongs into a layer below the
// scene: where nothing moved the two surfaces coincide, and only what sticks out is to be seen.
void build_rest_shape(vtkRenderer& renderer, const DeformationStep& step, const View& view);

}  // namespace hvp::draw
