#pragma once

#include <cstdint>

#include "app/scene/scene.h"

namespace hvp::app {

// How a loop is tried: device and hand begin in equilibrium in the wall, pushed into it by
// `push_N`, but for a part of the depth by which they are displaced. What is left of that
// displacement after `frames` says whether the loop is stable. The wall is never left by a loop
// that is.
struct TrialSettings {
  double push_N = 1;
  int frames = 2000;
};

// What one run of the platform showed.
struct Trial {
  bool stable = false;
  double growth = 0;       // of the swing about its mean (rms): last quarter over the second
  double amplitude_m = 0;  // half of peak to peak in the last quarter
  double delay_s = 0;      // from the latch to the force at the motor, the mean of all frames
};

// Displaced by this part of the depth. Half, so that a stable loop stays in the wall, and one count
// of an encoder is a small part of it.
inline constexpr double kDisplaced = 0.5;

// Runs the platform of a scenario with a wall of this stiffness (N/m, positive), in a process of
// its own. The scenario has [wall] and [device.dynamics]; its first probe is tried. A loop that
// swings on by more than an encoder step either way, or by what the registers' nanometre makes,
// without getting smaller is not stable; one that sticks is.
Trial try_wall(const Scene& scene, double stiffness_N_m, const TrialSettings& settings);

// The same of a body whose Young's modulus is so many times the scenario's. The scenario runs its
// own motion, all of its frames: the loop is stable where no device swings on while its user rests
// (plant::Oscillation), and somebody rested long enough to see it; throws InputError otherwise.
Trial try_body(const Scene& scene, double times);

// Force over depth of the deepest contact along the first probe's way, at rest and with the true
// matrix, N/m.
double contact_stiffness(const Scene& scene);

}  // namespace hvp::app
