#pragma once

#include "models/config/declaration.h"

namespace hvp::fixed {

enum class Method {
  cg,          // thesis §4.2
  jacobi_pcg,  // thesis §4.3
};

enum class Start {
  warm,  // from the previous solution
  zero,
};

// The scenario's table [solver]: method and words of the fixed-point solver.
struct Settings {
  Method method = Method::cg;
  Start start = Start::warm;
  // Updates of x. The thesis' pseudo-code, `cntr = 1; while (cntr < #m)`, makes #m - 1.
  int iterations = 60;
  int matrix_bits = 12;
  int vector_bits = 16;
  int coefficient_bits = 16;
  int static_shift = 11;  // m of thesis §4.2; cg only
  bool dynamic_scaling = true;
  int headroom_bits = 1;
  double displacement_range = 0.02;  // m

  void declare(config::Visitor& v);
  void check() const;

  // Bits that the product A·d drops when it is written to its 32-bit word. Thesis §5.5 has
  // 32-bit products of 12- and 16-bit factors: 4 bits for the growth of a row's sum. Wider
  // factors keep those 4 and lose the lowest bits.
  int product_shift() const {
    const int excess = matrix_bits + vector_bits + kGrowthBits - kProductBits;
    return excess > 0 ? excess : 0;
  }
  // Bits that the right-hand side drops: m of the static scaling for cg; for jacobi-pcg those
  // of the product, none with the thesis' words (§4.3: no static scaling).
  int rhs_shift() const { return method == Method::cg ? static_shift : product_shift(); }
  // Width of b and r: with static scaling that of the vectors, without it a wider word (§4.3
  // asks for one without a number; 32 is what was tried, facts in docs/fixed-point.md).
  int residual_bits() const { return method == Method::cg ? vector_bits : kProductBits; }

  static constexpr int kProductBits = 32;
  static constexpr int kGrowthBits = 4;
};

}  // namespace hvp::fixed
