#pragma once

#include <cstdint>

#include "app/scene/scene.h"

namespace hvp::app {

// The settings of a trial. Device and hand start near equilibrium in the wall, into which `push_N`
// presses them, displaced from it by a part of the depth. The loop is stable if that displacement
// has decayed after `frames`. A stable loop never leaves the wall.
struct TrialSettings {
  double push_N = 1;
  int frames = 2000;  // at least; more where the device swings slowly
};

// The result of one trial.
struct Trial {
  bool decided = true;  // false: its swing takes more frames than a trial has, and it was not run
  bool moved = false;   // false: friction held the device from the first frame on
  bool stable = false;
  bool clamped = false;  // a force was clamped
  bool pressed = true;   // false: the device never was in the wall
  double growth = 0;     // ratio of the rms swing about its mean, last quarter over second quarter
  double amplitude_m = 0;  // half of the peak-to-peak swing in the last quarter
  double delay_s = 0;      // from the latch to the force at the motor, mean of all frames
};

// The initial displacement as a part of the depth. It is half, so that a stable loop stays in the
// wall, and one encoder count is small beside it.
inline constexpr double kDisplaced = 0.5;

// Runs the platform with a wall of this positive stiffness in a process of its own. The scenario
// must have [wall] and [device.dynamics]; the trial uses its first probe. A loop is unstable if it
// keeps swinging, without decaying, by more than an encoder step either way or by more than the
// registers' resolution of 1 nm causes, or if a force is clamped to the end. A loop that sticks is
// stable.
Trial try_wall(const Scene& scene, double stiffness_N_m, const TrialSettings& settings);

// Tries the loop on a wall of this positive stiffness with the scenario's own motion, run for all
// frames, as try_body() does. Throws InputError if nobody rests long enough to tell.
Trial try_motion(const Scene& scene, double stiffness_N_m);

// Tries the loop with the scenario's Young's modulus multiplied by `times`. The scenario's own
// motion is run for all frames. The loop is stable if no device keeps swinging while its user rests
// (plant::Oscillation). Throws InputError if nobody rests long enough to tell.
Trial try_body(const Scene& scene, double times);

}  // namespace hvp::app
