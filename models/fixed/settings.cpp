#include "models/fixed/settings.h"

#include <string>

#include "models/config/input_error.h"
#include "models/fixed/stop_test.h"

namespace hvp::fixed {

namespace {

void rounding(config::Visitor& v, std::string_view name, Rounding& value, config::Note note) {
  v.choice(name, value,
           {{"nearest-even", Rounding::nearest_even},
            {"nearest-up", Rounding::nearest_up},
            {"truncation", Rounding::truncation}},
           note);
}

}  // namespace

void Settings::declare(config::Visitor& v) {
  v.choice("method", method,
           {{"cg", Method::cg},
            {"jacobi-pcg", Method::jacobi_pcg},
            {"block-jacobi-pcg", Method::block_jacobi_pcg},
            {"chronopoulos-gear", Method::chronopoulos_gear},
            {"pipelined-cg", Method::pipelined_cg}},
           {.help = "conjugate gradients: plain, with the diagonal or its 3 × 3 blocks as "
                    "preconditioner, or with fewer synchronisations",
            .source = "thesis §4.2: the hardware is plain CG; PCG is §4.3"});
  v.integer("iterations", iterations, {.min = 1, .max = 65535},
            {.help = "updates of the solution in every solve (the thesis' #m is one more)",
             .source = "thesis §4.2, Table 4.1: 60 suffice with a warm start"});
  v.quantity(
      "stop_residual", stop_residual, config::Dimension::dimensionless, config::between(0.0, 1.0),
      {.help = "ends a solve once |r| is at most so much of |b|, 1.5e-154 at least; 0: the count "
               "alone",
       .source = "thesis §4.2: the count is fixed"});
  v.integer("replace_residual_every", replace_residual_every, {.min = 0, .max = 65535},
            {.help = "iterations after which r = b - A·x is formed anew; 0: never",
             .source = "the thesis has none"});
  v.integer("matrix_bits", matrix_bits, {.min = 8, .max = 24},
            {.help = "word of a matrix entry, sign included", .source = "thesis §4.2"});
  v.integer("vector_bits", vector_bits, {.min = 12, .max = 32},
            {.help = "word of x and d (and of b and r without a preconditioner), sign included",
             .source = "thesis §4.2"});
  v.integer("scalar_bits", scalar_bits, {.min = 64, .max = 128},
            {.help = "word of the inner products: 64 or 128", .source = "thesis §4.2"});
  v.integer("coefficient_bits", coefficient_bits, {.min = 8, .max = 24},
            {.help = "mantissa of alpha and beta, sign included",
             .source = "thesis §4.2: 16-bit signed"});
  const auto of_format = v.variant(
      "coefficient_format", coefficient_format,
      {{"own-shift", CoefficientFormat::own_shift}, {"fixed", CoefficientFormat::fixed}},
      {.help = "alpha and beta with a shift of their own every iteration, or a fixed point",
       .source = "the thesis leaves it open; docs/fixed-point.md has the measurement"});
  of_format.only({CoefficientFormat::fixed}, [&] {
    v.integer(
        "alpha_fraction_bits", alpha_fraction_bits, {.min = 0, .max = 40},
        {.help = "bits of alpha behind the point",
         .source = "alpha lies between 1/λ_max and 1/λ_min of a 12-bit matrix: 2^-13 to 2^-1"});
    v.integer("beta_fraction_bits", beta_fraction_bits, {.min = 0, .max = 40},
              {.help = "bits of beta behind the point",
               .source = "beta reaches 1.8: two bits before the point, docs/fixed-point.md"});
  });
  rounding(v, "division_rounding", division_rounding,
           {.help = "what a division does with what is left (on the magnitude)",
            .source = "thesis §4.2: to nearest"});
  rounding(v, "shift_rounding", shift_rounding,
           {.help = "what a shift does with the bits that it drops (on the magnitude)",
            .source = "the thesis leaves it open; docs/fixed-point.md has the measurement"});
  v.choice("overflow", overflow, {{"saturate", Overflow::saturate}, {"wrap", Overflow::wrap}},
           {.help = "what a value beyond its word becomes; either is counted and flagged",
            .source = "the thesis leaves it open; a wrapped word is never right"});
  v.choice("matrix_scaling", matrix_scaling,
           {{"none", MatrixScaling::none}, {"diagonal", MatrixScaling::diagonal}},
           {.help = "what is done to the matrix before it is rounded: diagonal makes every "
                    "diagonal entry equal, and the host scales b and u",
            .source = "the thesis has none"});
  v.choice("static_scale", static_scale,
           {{"given", StaticScale::given}, {"matrix-norm", StaticScale::matrix_norm}},
           {.help = "the static scale m: static_shift, or the least that the matrix' row sums "
                    "cannot overflow",
            .source = "thesis §4.2 gives a range for m"});
  v.integer("static_shift", static_shift, {.min = kShiftOfWords, .max = 31},
            {.help = "m: b, r and d are scaled down by 2^m; -1: matrix_bits - 1; methods without a "
                     "preconditioner",
             .source = "thesis §4.2: 9 to 12 with 12-bit words; 8 and 9 saturate, 11 does not, "
                       "docs/fixed-point.md"});
  v.boolean("dynamic_scaling", dynamic_scaling,
            {.help = "re-scale r and d by powers of two as they shrink and grow",
             .source = "thesis §4.2; the rule is ours, docs/fixed-point.md"});
  v.boolean("scaling_down", scaling_down,
            {.help = "dynamic scaling also makes room where a vector grows",
             .source = "measured: without it PCG diverged, docs/fixed-point.md"});
  v.integer("scaling_threshold", scaling_threshold, {.min = 1, .max = 16},
            {.help = "bits free beyond headroom_bits before dynamic scaling scales up",
             .source = "measured, docs/fixed-point.md"});
  v.integer("scaling_step", scaling_step, {.min = 1, .max = 16},
            {.help = "a re-scaling is a multiple of so many bits",
             .source = "measured, docs/fixed-point.md"});
  v.integer("headroom_bits", headroom_bits, {.min = 0, .max = 8},
            {.help = "free bits that dynamic scaling leaves when it scales up",
             .source = "measured, docs/fixed-point.md"});
  v.choice("start", start,
           {{"warm", Start::warm}, {"zero", Start::zero}, {"extrapolated", Start::extrapolated}},
           {.help = "where a solve starts: from the previous solution, from zero, or from the "
                    "line through the last two solutions",
            .source = "thesis §4.2: the previous solution is a good guess at haptic rates"});
  v.quantity("displacement_range", displacement_range, config::Dimension::length,
             config::between(1e-9, 1e3),
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
  if (stop_residual > 0 && stop_residual < StopTest::kLeast) {
    throw InputError("stop_residual",
                     "expected 0, or at least 2^-511 (1.5e-154): below that the board's stop test "
                     "has no bits of its square");
  }
  if (scalar_bits != 64 && scalar_bits != 128) {
    throw InputError("scalar_bits", std::to_string(scalar_bits) + " bits; 64 or 128 were expected");
  }
}

}  // namespace hvp::fixed
