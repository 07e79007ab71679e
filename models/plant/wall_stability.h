#pragma once

#include "models/plant/linear_axis.h"

namespace hvp::plant {

// A device, held or free, in front of a virtual wall that the host renders with a delay: once a
// period T it reads x_n and makes F_n = −K·x_n − B·(x_n − x_{n−1})/T, which acts from n·T + L for a
// period. Contact is always there: the wall as a spring, the smallest of its motions.
struct WallLoop {
  LinearAxis device;  // with its amplifier's lag, and with the hand, whose intention rests
  double period_s = 2e-3;
  double delay_s = 0;  // L, of any length
  double damping = 0;  // B, N·s/m
};

// The largest modulus of the eigenvalues of the loop's map from one sample to the next, exact:
// below one the loop is stable.
double spectral_radius(const WallLoop& loop, double stiffness);

// The stiffness K up to which every loop is stable, N/m, to a relative 1e-9; 0 where none is. An
// instability that a larger K would mend counts.
double largest_stable_stiffness(const WallLoop& loop);

// What a part of the delay (s, at most all of it) costs: by how much N/m largest_stable_stiffness
// would be larger without it.
double stiffness_cost(const WallLoop& loop, double part_s);

// Below it the wall is passive, so that no hand can make it unstable: b > K·(T/2 + L) + |B|
// (Colgate & Schenkel 1997, with their delay of whole samples taken for any L, and the time
// constant of an amplifier's lag as a part of it). Only the device's own damping counts, not the
// hand's. 0 where none is.
double passive_stiffness(const WallLoop& loop, double device_damping);

}  // namespace hvp::plant
