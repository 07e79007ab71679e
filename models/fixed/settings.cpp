#include "models/fixed/settings.h"

#include <string>

#include "models/config/input_error.h"

namespace hvp::fixed {

void Settings::declare(config::Visitor& v) {
  v.choice("method", method, {{"cg", Method::cg}, {"jacobi-pcg", Method::jacobi_pcg}},
           {.help = "conjugate gradients, plain or with the diagonal as preconditioner",
            .source = "thesis §4.2: the hardware is plain CG; PCG is §4.3"});
  v.integer("iterations", iterations, {.min = 1, .max = 100000},
            {.help = "updates of the solution in every solve (the thesis' #m is one more)",
             .source = "thesis §4.2, Table 4.1: 60 suffice with a warm start"});
  v.integer("matrix_bits", matrix_bits, {.min = 8, .max = 24},
            {.help = "word of a matrix entry, sign included", .source = "thesis §4.2"});
  v.integer("vector_bits", vector_bits, {.min = 12, .max = 32},
            {.help = "word of x and d (and of b and r with method cg), sign included",
             .source = "thesis §4.2"});
  v.integer("coefficient_bits", coefficient_bits, {.min = 8, .max = 24},
            {.help = "mantissa of alpha and beta, sign included; each has a shift of its own",
             .source = "thesis §4.2: 16-bit signed; the shift is ours, docs/fixed-point.md"});
  v.integer("static_shift", static_shift, {.min = 0, .max = 31},
            {.help = "m: b, r and d are scaled down by 2^m; method cg only",
             .source = "thesis §4.2: 9 to 12; 8 and 9 saturate, docs/fixed-point.md"});
  v.boolean("dynamic_scaling", dynamic_scaling,
            {.help = "re-scale r and d by powers of two as they shrink and grow",
             .source = "thesis §4.2; the rule is ours, docs/fixed-point.md"});
  v.integer("headroom_bits", headroom_bits, {.min = 0, .max = 8},
            {.help = "free bits that dynamic scaling leaves when it scales up",
             .source = "measured, docs/fixed-point.md"});
  v.choice("start", start, {{"warm", Start::warm}, {"zero", Start::zero}},
           {.help = "where a solve starts: from the previous solution, or from zero",
            .source = "thesis §4.2: the previous solution is a good guess at haptic rates"});
  v.quantity("displacement_range", displacement_range, config::Dimension::length,
             config::above(0.0),
             {.help = "the displacement that fills the vector word; larger ones are clamped",
              .source = "0.4 R of the thesis' scene (R = 5 cm), twice a press of 0.2 R"});
}

void Settings::check() const {
  // r and d need some bits besides the free ones to carry a value at all.
  constexpr int kLeastMagnitude = 6;
  if (headroom_bits > vector_bits - 1 - kLeastMagnitude) {
    throw InputError("headroom_bits",
                     std::to_string(headroom_bits) + " free bits leave fewer than " +
                         std::to_string(kLeastMagnitude) + " bits of magnitude in a word of " +
                         std::to_string(vector_bits) + " bits; at most " +
                         std::to_string(vector_bits - 1 - kLeastMagnitude) + " were expected");
  }
}

}  // namespace hvp::fixed
