#pragma once

namespace hvp::random {

// Logarithm and exponential by series in IEEE 754's four operations. A C library's own differ in
// the last bit from one version or processor to the next, and a draw would with them. The error is
// below 4 units in the last place; tests/random compares.

// Of a positive normal number.
double natural_log(double x);

// Of −700 to 700.
double exponential(double x);

}  // namespace hvp::random
