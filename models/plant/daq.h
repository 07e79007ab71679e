#pragma once

#include <cstdint>

#include "models/config/declaration.h"

namespace hvp::plant {

// A number in a register's counts.
struct Counts {
  std::int32_t value = 0;
  // The number did not fit, or was NaN, and `value` is not what was asked for.
  bool saturated = false;
};

// The format of a physical quantity in the board's 32-bit registers: a signed integer of
// `counts_per_unit` counts per SI unit.
//
// This is the transport format of an ideal device, whose step is negligible beside everything else.
// It is neither the encoder's step nor the converter's: those are effects of the device and round
// the physical value before it gets here.
struct RegisterFormat {
  double counts_per_unit = 1.0;

  // Nearest count, halves away from zero. Beyond ±(2³¹ − 1) counts the nearest of those two
  // (never −2³¹, so that a sign can always be changed); NaN gives 0. Both report.
  Counts to_counts(double value) const;
  double to_value(std::int32_t counts) const { return counts / counts_per_unit; }
  double largest() const { return to_value(2147483647); }
};

inline constexpr RegisterFormat kPosition{1e9};  // 1 nm, ±2.147 m
inline constexpr RegisterFormat kForce{1e6};     // 1 µN, ±2147 N
inline constexpr RegisterFormat kCurrent{1e6};   // 1 µA, ±2147 A

// The data acquisition board: scenario table [device.daq]. It has two delays. `sampling_delay` lies
// between the command to sample and a position that can be read; `output_delay` lies between the
// last register write and the force at the motor. The sampled position is that of the moment of the
// command (the counters latch at once); only the word is late.
//
// The registers' access times belong to the bus. The limits and steps of the device itself (the
// largest force of motor and amplifier, the encoder's step, the converter's step, friction) are
// effects with tables of their own beside this one, applied to positions before to_counts and to
// forces after to_value.
struct Daq {
  double sampling_delay = 1e-6;  // s
  double output_delay = 10e-6;   // s

  void declare(config::Visitor& v);
};

}  // namespace hvp::plant
