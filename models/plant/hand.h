#pragma once

#include "models/config/declaration.h"
#include "models/plant/linear_axis.h"

namespace hvp::plant {

// The effect [hand]: a spring and a damper between the intended motion, [probe], and a mass, and a
// grip between that and the device (LinearAxis). The same along each axis.
struct Hand {
  enum class Model { spring_damper, arm, custom };

  double mass_kg = 0;
  double stiffness_N_m = 375;
  double damping_N_s_m = 4.5;
  double grip_stiffness_N_m = 0;  // 0: rigid
  double grip_damping_N_s_m = 0;
  double lets_go_s = 0;  // from then on the device is free; 0: never
  Model model = Model::spring_damper;

  // The values of a named model; of `custom` those of the default.
  static Hand of(Model model);

  void declare(config::Visitor& v);
  // Throws InputError: a grip between the device and nothing, or one that only damps.
  void check() const;

  // Gives the hand's part to an axis.
  void hold(LinearAxis& axis) const;
};

}  // namespace hvp::plant
