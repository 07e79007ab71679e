#pragma once

#include "models/plant/linear_axis.h"

namespace hvp::plant {

// A device, in a hand or free, in front of a virtual wall that the host renders with a delay: once
// a period T it reads x_n and computes F_n = −K·x_n − B·(x_n − x_{n−1})/T, which acts from n·T + L
// for a period. The tip is always in contact: for the smallest motions the wall is a spring.
struct WallLoop {
  LinearAxis device;  // with its amplifier's lag, and with the hand, whose intention rests
  double period_s = 2e-3;
  double delay_s = 0;  // L, of any length
  double damping = 0;  // B, N·s/m
};

// The spectral radius of the loop's map from one sample to the next, exact: below one the loop is
// stable.
double spectral_radius(const WallLoop& loop, double stiffness);

// The stiffness K up to which every loop is stable, N/m, to a relative 1e-9; 0 where no loop is. An
// instability that ends at a larger K counts too.
double largest_stable_stiffness(const WallLoop& loop);

// The cost of a part of the delay (s, at most all of it): the amount by which
// largest_stable_stiffness() would be larger without it, N/m.
double stiffness_cost(const WallLoop& loop, double part_s);

// The stiffness below which the wall is passive, so that no hand can make it unstable: b > K·(T/2 +
// L) + |B| (Colgate & Schenkel 1997, with their delay of whole samples replaced by any L, and the
// time constant of an amplifier's lag as a part of it). Only the device's own damping counts, not
// the hand's. 0 where there is none.
double passive_stiffness(const WallLoop& loop, double device_damping);

}  // namespace hvp::plant
