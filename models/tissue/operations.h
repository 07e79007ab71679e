#pragma once

namespace hvp::tissue {

// What a computation takes, by kind. models/host prices additions, multiplications and divisions
// alike, and total() follows it: a root or a logarithm, which costs a host more, is one as well.
struct Operations {
  double add_multiply = 0;  // additions, subtractions and multiplications
  double divisions = 0;
  double functions = 0;  // square and cube roots, logarithms and exponentials

  constexpr double total() const { return add_multiply + divisions + functions; }

  constexpr Operations& operator+=(const Operations& other) {
    add_multiply += other.add_multiply;
    divisions += other.divisions;
    functions += other.functions;
    return *this;
  }
  friend constexpr Operations operator+(Operations a, const Operations& b) { return a += b; }
  friend constexpr Operations operator*(double times, const Operations& one) {
    return {times * one.add_multiply, times * one.divisions, times * one.functions};
  }
  friend constexpr bool operator==(const Operations&, const Operations&) = default;
};

}  // namespace hvp::tissue
