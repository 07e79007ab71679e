#pragma once

#include <cmath>
#include <ostream>

#include "models/tissue/operations.h"

namespace hvp::tissue {

// A number that counts what is done with numbers. A change of sign and a comparison are free.
struct Counted {
  double v = 0;

  Counted() = default;
  explicit Counted(double value) : v(value) {}

  static inline Operations count;

  friend Counted operator+(Counted a, Counted b) { return add_multiply(a.v + b.v); }
  friend Counted operator-(Counted a, Counted b) { return add_multiply(a.v - b.v); }
  friend Counted operator*(Counted a, Counted b) { return add_multiply(a.v * b.v); }
  friend Counted operator/(Counted a, Counted b) {
    ++count.divisions;
    return Counted(a.v / b.v);
  }
  friend Counted operator-(Counted a) { return Counted(-a.v); }
  friend bool operator<(Counted a, Counted b) { return a.v < b.v; }
  friend bool operator>(Counted a, Counted b) { return a.v > b.v; }
  friend bool operator==(Counted a, Counted b) { return a.v == b.v; }
  friend Counted sqrt(Counted a) { return function(std::sqrt(a.v)); }
  friend Counted cbrt(Counted a) { return function(std::cbrt(a.v)); }
  friend Counted log(Counted a) { return function(std::log(a.v)); }
  friend Counted exp(Counted a) { return function(std::exp(a.v)); }
  friend Counted expm1(Counted a) { return function(std::expm1(a.v)); }

 private:
  static Counted add_multiply(double value) {
    ++count.add_multiply;
    return Counted(value);
  }
  static Counted function(double value) {
    ++count.functions;
    return Counted(value);
  }
};

// How a failed expectation prints them.
inline void PrintTo(const Operations& o, std::ostream* out) {
  *out << o.add_multiply << " + and *, " << o.divisions << " divisions, " << o.functions
       << " functions";
}

}  // namespace hvp::tissue
