#pragma once

#include <cstdint>

#include "models/config/declaration.h"

namespace hvp::fixed {

enum class Method {
  cg,                // thesis §4.2
  jacobi_pcg,        // thesis §4.3
  block_jacobi_pcg,  // with the inverse 3 × 3 blocks of the diagonal
  // Both inner products of an iteration at once (Chronopoulos and Gear 1989): one
  // synchronisation, and A·d by a recurrence.
  chronopoulos_gear,
  // The same, at the same time as the matrix-vector product (Ghysels and Vanroose 2014): no
  // synchronisation waits.
  pipelined_cg,
};

enum class Start {
  warm,  // from the previous solution
  zero,
  extrapolated,  // from 2·(previous solution) − (the one before), which the caller forms
};

// The rounding of bits for which a word has no room. All three kinds act on the magnitude, as sign
// and magnitude hardware does (thesis §5.5), so that every operation is odd.
enum class Rounding {
  nearest_even,  // ties to the even word
  nearest_up,    // ties away from zero: one adder behind the shifter
  truncation,    // towards zero: nothing behind it
};

// The treatment of a value beyond its word. Both kinds are counted.
enum class Overflow { saturate, wrap };

// The format of α and β: a mantissa with its own shift in every iteration, or a fixed point.
enum class CoefficientFormat { own_shift, fixed };

enum class StaticScale { given, matrix_norm };

// The scaling of the matrix before it is rounded.
enum class MatrixScaling {
  none,
  diagonal,  // S·A·S with s_i = 1/√a_ii: the diagonal becomes one
};

// The scenario's table [solver]: method, words and rules of the fixed-point solver.
// docs/fixed-point.md defines each of them to the bit.
struct Settings {
  Method method = Method::cg;
  Start start = Start::warm;
  // The number of updates of x. The thesis' pseudo-code, `cntr = 1; while (cntr < #m)`, makes #m -
  // 1.
  int iterations = 60;
  // A solve ends once ‖r‖ <= stop_residual · ‖b‖; 0: the number of iterations alone ends it.
  double stop_residual = 0;
  // The number of iterations after which r = b - A·x is formed anew; 0: never.
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
  int scaling_threshold = 1;  // bits that must be free beyond headroom_bits before scaling up
  int scaling_step = 1;       // a re-scaling is a multiple of this number of bits
  int headroom_bits = 1;
  double displacement_range = 0.02;  // m

  void declare(config::Visitor& v);
  void check() const;

  bool preconditioned() const {
    return method == Method::jacobi_pcg || method == Method::block_jacobi_pcg;
  }

  // The bits that the product A·d drops when it is written to its 32-bit word. Thesis §5.5 has
  // 32-bit products of 12- and 16-bit factors: 4 bits for the growth of a row's sum. Wider factors
  // keep those 4 and lose the lowest bits.
  int product_shift() const {
    const int excess = matrix_bits + vector_bits + kGrowthBits - kProductBits;
    return excess > 0 ? excess : 0;
  }
  // The bits that the right-hand side drops: m of the static scaling, or with a preconditioner
  // those of the product, which are none with the thesis' words (§4.3: no static scaling).
  int rhs_shift() const { return preconditioned() ? product_shift() : shift(); }
  // m, unless prepare() finds it in the matrix. The largest word of the matrix then counts as one,
  // as with the thesis' m = 11 and its 12-bit words.
  int shift() const { return static_shift == kShiftOfWords ? matrix_bits - 1 : static_shift; }
  // The width of b and r: that of the vectors with static scaling, otherwise a wider word. Thesis
  // §4.3 asks for one without giving a number; docs/fixed-point.md has the facts for 32.
  int residual_bits() const { return preconditioned() ? kProductBits : vector_bits; }

  static constexpr int kShiftOfWords = -1;
  static constexpr int kProductBits = 32;
  static constexpr int kGrowthBits = 4;

  friend bool operator==(const Settings&, const Settings&) = default;
};

}  // namespace hvp::fixed
