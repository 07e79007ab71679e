#include "vp/fpga/rtl/rtl_comparison.h"

#include <algorithm>
#include <numeric>

#include "models/index.h"

namespace hvp::vp::rtl {

namespace {

// The first state of a solve; a copy of x may have begun behind it.
constexpr auto kFirstState = static_cast<std::size_t>(engine::State::guess);

std::int64_t solve_clocks(const engine::StateClocks& clocks) {
  return std::accumulate(clocks.begin() + kFirstState, clocks.end(), std::int64_t{0});
}

// The flags of the diagonal are found when the matrix is loaded; a breakdown is counted beside its
// flag.
stability::Flags of_hardware(stability::Flags flags) {
  using stability::Flag;
  return flags.without(Flag::zero_diagonal).without(Flag::negative_curvature);
}

}  // namespace

void RtlComparison::load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) {
  solving_ = false;
  rtl_.load(matrix, settings);
}

void RtlComparison::write_x(std::span<const std::int32_t> words) {
  copied_from_ = sc_core::sc_time_stamp();
  rtl_.write_x(words);
}

std::int64_t RtlComparison::edges_since(const sc_core::sc_time& time) const {
  const sc_core::sc_time passed = sc_core::sc_time_stamp() - time;
  return static_cast<std::int64_t>(passed.value() / engine_.clock().period().value());
}

void RtlComparison::start_solve(const fixed::Settings& settings) {
  started_ = sc_core::sc_time_stamp();
  const bool copies = engine_.sequencer().state() == engine::State::copy;
  waited_ = copies ? rtl_.copy_clocks() - edges_since(copied_from_) : 0;
  rtl_.start_solve(settings);
  solving_ = true;
}

void RtlComparison::compare(const std::string& what, std::int64_t rtl, std::int64_t model) {
  if (rtl == model || !difference_.empty()) return;
  difference_ = what + " is " + std::to_string(rtl) + " in RTL and " + std::to_string(model) +
                " in the cycle-accurate engine at clock " + std::to_string(rtl_.clocks()) +
                " of the solve, iteration " + std::to_string(rtl_.ports().iterations_made);
}

void RtlComparison::iteration(const fixed::IterationState& state) {
  if (!difference_.empty()) return;
  rtl_.run_iteration();
  const EnginePorts& ports = rtl_.ports();
  compare("the iteration's number", ports.iterations_made, state.iteration);
  compare("dᵀ·A·d", ports.d_q, static_cast<std::int64_t>(state.d_q));
  compare("the mantissa of alpha", ports.alpha, state.alpha.mantissa);
  compare("the exponent of alpha·q", ports.alpha_exponent, state.alpha.exponent);
  compare("the exponent of r", ports.r_exponent + rtl_.settings().rhs_shift(),
          state.residual_exponent);
  compare(rtl_.settings().preconditioned() ? "zᵀ·r" : "rᵀ·r", ports.z_r,
          static_cast<std::int64_t>(state.z_r));
  compare("the mantissa of beta", ports.beta, state.beta.mantissa);
  compare("the exponent of beta", ports.beta_exponent, state.beta.exponent);
  compare("the exponent of d less that of z", ports.d_exponent - ports.z_exponent,
          state.direction_exponent);
}

void RtlComparison::compare_x() {
  const auto words = 3 * at(engine_.layout().nodes());
  x_.resize(words);
  model_x_.resize(words);
  rtl_.read_x(x_);
  engine_.read_x(model_x_);
  const auto [rtl, model] = std::ranges::mismatch(x_, model_x_);
  if (rtl == x_.end()) return;
  const auto word = rtl - x_.begin();
  compare("x, component " + std::to_string(word % 3) + " of node " + std::to_string(word / 3), *rtl,
          *model);
}

void RtlComparison::end_solve() {
  solving_ = false;
  copied_from_ = sc_core::sc_time_stamp();
  if (!difference_.empty()) return;
  rtl_.run_to_end();
  compared_clocks_ += rtl_.clocks();
  const engine::StateClocks& rtl = rtl_.state_clocks();
  const engine::StateClocks& model = engine_.state_clocks();
  for (std::size_t i = kFirstState; i < rtl.size(); ++i) {
    compare(std::string("the number of clocks in the state ") +
                engine::name(static_cast<engine::State>(i)),
            rtl[i], model[i]);
  }
  compare("the number of clocks", rtl_.clocks(), solve_clocks(model));
  compare_x();
  const fixed::Report is = rtl_.report();
  const fixed::Report should = engine_.report();
  compare("the number of iterations", is.iterations, should.iterations);
  compare("the end by the stop test", is.reached ? 1 : 0, should.reached ? 1 : 0);
  compare("the number of residuals formed anew", is.replacements, should.replacements);
  compare("the number of clamped words", is.saturations, should.saturations);
  compare("the number of breakdowns", is.breakdowns, should.breakdowns);
  compare("the set of flags", of_hardware(is.flags).bits(), of_hardware(should.flags).bits());
  rtl_.copy_x();
}

void RtlComparison::invert() {
  compare("the number of clocks in which the matrix is taken over", rtl_.invert(),
          engine_.update_clocks());
}

void RtlComparison::constrain(int node, std::int32_t diagonal) {
  compare("the number of clocks in which node " + std::to_string(node) + " is constrained",
          rtl_.constrain(node, diagonal), engine_.update_clocks());
}

void RtlComparison::restore(int node, std::span<const std::int32_t> row) {
  compare("the number of clocks in which node " + std::to_string(node) + " is restored",
          rtl_.restore(node, row), engine_.update_clocks());
}

void RtlComparison::abort() {
  const bool compares =
      solving_ && difference_.empty() && engine_.sequencer().state() != engine::State::copy;
  if (compares) rtl_.run_until(edges_since(started_) - waited_);
  solving_ = false;
  rtl_.abort();
  if (compares) compare_x();
}

}  // namespace hvp::vp::rtl
