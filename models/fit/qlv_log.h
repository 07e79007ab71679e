#pragma once

#include <string>
#include <vector>

namespace hvp::fit {

// An indenter pressed into tissue: how far it has travelled and what force that takes. The record
// begins before contact, or long after any load. Sign and origin of the travel do not matter.
struct IndentationLog {
  std::vector<double> time;    // s
  std::vector<double> travel;  // m
  std::vector<double> force;   // N
};

// The same with force and depth growing as the indenter is pressed, from the last sample before it
// moves on: on real machines the zero of the force jumps as the drive starts, by 10 to 16 mN in
// five of six records of one, and a model of the tissue should not answer for that.
struct PressedLog {
  std::vector<double> time;   // s
  std::vector<double> depth;  // m, direction · travel
  std::vector<double> force;  // N
  double direction = 1;       // 1 or −1
  double step = 0;            // s, the median
  std::vector<std::string> warnings;

  double stroke() const;          // m
  double force_range() const;     // N
  double seconds() const;         // from the first sample to the last
  double shallowest() const;      // m, of `depth`
  double deepest() const;         // m
  double before_contact() const;  // N, at the beginning
  double first_loaded() const;    // m, the depth where the force has begun to rise
};

// Throws InputError: fewer than 20 samples, columns of different lengths, numbers that are not
// finite, time that does not go on in even steps, no motion, no change of force, lengths or forces
// that look like another unit.
PressedLog pressed(const IndentationLog& log);

}  // namespace hvp::fit
