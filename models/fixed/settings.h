#pragma once

#include <cstdint>

#include "models/config/declaration.h"

namespace hvp::fixed {

enum class Method {
  cg,                // thesis §4.2
  jacobi_pcg,        // thesis §4.3
  block_jacobi_pcg,  // the same with the inverse 3 × 3 blocks of the diagonal
  // Both inner products of an iteration at once (Chronopoulos and Gear 1989): one
  // synchronisation, and A·d by a recurrence.
  chronopoulos_gear,
  // And those beside the matrix-vector product (Ghysels and Vanroose 2014): none that waits.
  pipelined_cg,
};

enum class Start {
  warm,  // from the previous solution
  zero,
  extrapolated,  // from 2·(the previous solution) − (the one before): the caller forms it
};

// What becomes of the bits that a word has no room for. All three act on the magnitude, as
// sign and magnitude hardware does (thesis §5.5), so that every operation is odd.
enum class Rounding {
  nearest_even,  // ties to the even word
  nearest_up,    // ties away from zero: one adder behind the shifter
  truncation,    // towards zero: nothing behind it
};

// What becomes of a value beyond its word. Both are counted.
enum class Overflow { saturate, wrap };

// α and β: a mantissa with a shift of its own every iteration, or a fixed point.
enum class CoefficientFormat { own_shift, fixed };

enum class StaticScale { given, matrix_norm };

// What is done to the matrix before it is rounded.
enum class MatrixScaling {
  none,
  diagonal,  // S·A·S with s_i = 1/√a_ii: the diagonal becomes one
};

// The scenario's table [solver]: method, words and rules of the fixed-point solver.
// docs/fixed-point.md defines each of them to the bit.
struct Settings {
  Method method = Method::cg;
  Start start = Start::warm;
  // Updates of x. The thesis' pseudo-code, `cntr = 1; while (cntr < #m)`, makes #m - 1.
  int iterations = 60;
  // Ends a solve once ‖r‖ <= stop_residual · ‖b‖; 0: the count alone.
  double stop_residual = 0;
  // r = b - A·x is formed anew after every so many iterations; 0: never.
  int replace_residual_every = 0;

  int matrix_bits = 12;
  int vector_bits = 16;
  int scalar_bits = 64;
  int coefficient_bits = 16;
  CoefficientFormat coefficient_format = CoefficientFormat::own_shift;
  int alpha_fraction_bits = 24;  // CoefficientFormat::fixed only
  int beta_fraction_bits = 13;
  Rounding division_rounding = Rounding::nearest_up;
  Rounding shift_rounding = Rounding::nearest_up;
  Overflow overflow = Overflow::saturate;

  MatrixScaling matrix_scaling = MatrixScaling::none;
  StaticScale static_scale = StaticScale::given;
  int static_shift = kShiftOfWords;  // m of thesis §4.2; methods without a preconditioner only
  bool dynamic_scaling = true;
  bool scaling_down = true;   // dynamic scaling also makes room where a vector grows
  int scaling_threshold = 1;  // bits that must be free beyond headroom_bits before it scales up
  int scaling_step = 1;       // a re-scaling is a multiple of so many bits
  int headroom_bits = 1;
  double displacement_range = 0.02;  // m

  void declare(config::Visitor& v);
  void check() const;

  bool preconditioned() const {
    return method == Method::jacobi_pcg || method == Method::block_jacobi_pcg;
  }

  // Bits that the product A·d drops when it is written to its 32-bit word. Thesis §5.5 has
  // 32-bit products of 12- and 16-bit factors: 4 bits for the growth of a row's sum. Wider
  // factors keep those 4 and lose the lowest bits.
  int product_shift() const {
    const int excess = matrix_bits + vector_bits + kGrowthBits - kProductBits;
    return excess > 0 ? excess : 0;
  }
  // Bits that the right-hand side drops: m of the static scaling, or with a preconditioner
  // those of the product, none with the thesis' words (§4.3: no static scaling).
  int rhs_shift() const { return preconditioned() ? product_shift() : shift(); }
  // m where prepare() does not find it in the matrix. The largest word of the matrix then counts as
  // one, as the thesis' 11 does with its 12-bit words.
  int shift() const { return static_shift == kShiftOfWords ? matrix_bits - 1 : static_shift; }
  // Width of b and r: with static scaling that of the vectors, without it a wider word (§4.3
  // asks for one without a number; 32 is what was tried, facts in docs/fixed-point.md).
  int residual_bits() const { return preconditioned() ? kProductBits : vector_bits; }

  static constexpr int kShiftOfWords = -1;
  static constexpr int kProductBits = 32;
  static constexpr int kGrowthBits = 4;

  friend bool operator==(const Settings&, const Settings&) = default;
};

}  // namespace hvp::fixed
