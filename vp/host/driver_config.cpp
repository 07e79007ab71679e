#include "vp/host/driver_config.h"

#include <bit>
#include <cstdint>

namespace hvp::vp {

namespace {

hvp_method method_of(fixed::Method method) {
  switch (method) {
    case fixed::Method::cg:
      return HVP_METHOD_CG;
    case fixed::Method::jacobi_pcg:
      return HVP_METHOD_JACOBI_PCG;
    case fixed::Method::block_jacobi_pcg:
      return HVP_METHOD_BLOCK_JACOBI_PCG;
    case fixed::Method::chronopoulos_gear:
      return HVP_METHOD_CHRONOPOULOS_GEAR;
    case fixed::Method::pipelined_cg:
      return HVP_METHOD_PIPELINED_CG;
  }
  return HVP_METHOD_COUNT;
}

hvp_start_from start_of(fixed::Start start) {
  switch (start) {
    case fixed::Start::warm:
      return HVP_START_FROM_LAST;
    case fixed::Start::zero:
      return HVP_START_FROM_ZERO;
    case fixed::Start::extrapolated:
      return HVP_START_FROM_EXTRAPOLATED;
  }
  return HVP_START_FROM_COUNT;
}

hvp_round rounding_of(fixed::Rounding rounding) {
  switch (rounding) {
    case fixed::Rounding::nearest_up:
      return HVP_ROUND_NEAREST_UP;
    case fixed::Rounding::nearest_even:
      return HVP_ROUND_NEAREST_EVEN;
    case fixed::Rounding::truncation:
      return HVP_ROUND_TRUNCATION;
  }
  return HVP_ROUND_COUNT;
}

}  // namespace

hvp_solver_config driver_config(const fixed::Settings& s) {
  hvp_solver_config c{};
  c.method = method_of(s.method);
  c.start = start_of(s.start);
  c.iterations = static_cast<std::uint32_t>(s.iterations);
  // -0.0 is a zero too, with other bits.
  if (s.stop_residual > 0) c.stop_residual = std::bit_cast<std::uint64_t>(s.stop_residual);
  c.replace_every = static_cast<std::uint32_t>(s.replace_residual_every);
  c.static_shift = static_cast<std::uint32_t>(s.shift());
  c.dynamic_scaling = s.dynamic_scaling;
  c.scaling_up_only = !s.scaling_down;
  c.headroom_bits = static_cast<std::uint32_t>(s.headroom_bits);
  c.scaling_threshold = static_cast<std::uint32_t>(s.scaling_threshold);
  c.scaling_step = static_cast<std::uint32_t>(s.scaling_step);
  c.matrix_bits = static_cast<std::uint32_t>(s.matrix_bits);
  c.vector_bits = static_cast<std::uint32_t>(s.vector_bits);
  c.rhs_bits = static_cast<std::uint32_t>(s.residual_bits());
  c.scalar_bits = static_cast<std::uint32_t>(s.scalar_bits);
  c.coefficient_bits = static_cast<std::uint32_t>(s.coefficient_bits);
  c.fixed_coefficients = s.coefficient_format == fixed::CoefficientFormat::fixed;
  c.alpha_fraction = static_cast<std::uint32_t>(s.alpha_fraction_bits);
  c.beta_fraction = static_cast<std::uint32_t>(s.beta_fraction_bits);
  c.division_rounding = rounding_of(s.division_rounding);
  c.shift_rounding = rounding_of(s.shift_rounding);
  c.wrap_overflow = s.overflow == fixed::Overflow::wrap;
  return c;
}

}  // namespace hvp::vp
