#include "vp/fpga/engine/phase_engine.h"

#include <algorithm>
#include <cstddef>

#include "vp/fpga/engine/cycle_engine.h"

namespace hvp::vp::engine {

namespace {

struct EnginePhase {
  std::int64_t clocks = 0;
  unsigned units = 0;  // a bit a unit
};

constexpr unsigned bit(PhaseEngine::Unit unit) { return 1U << static_cast<unsigned>(unit); }
constexpr unsigned kVectors = bit(PhaseEngine::Unit::vectors);
constexpr unsigned kVectorsAndDirection = kVectors | bit(PhaseEngine::Unit::direction);
constexpr unsigned kProduct = kVectorsAndDirection | bit(PhaseEngine::Unit::matrix);
constexpr unsigned kDivider = bit(PhaseEngine::Unit::divider);

}  // namespace

PhaseEngine::PhaseEngine(const sc_core::sc_module_name& name,
                         const accel::Architecture& architecture)
    : sc_module(name),
      architecture_(architecture),
      period_(static_cast<double>(architecture.clock_period_ps()), sc_core::SC_PS),
      over_("over"),
      done_("done") {
  require_supported(architecture);
  SC_HAS_PROCESS(PhaseEngine);
  SC_METHOD(advance);
  sensitive << over_;
  dont_initialize();
}

void PhaseEngine::load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) {
  require_supported(settings);
  layout_.emplace(architecture_, matrix.row_begin, matrix.column);
  phases_ = phase_clocks(architecture_, *layout_);
  copied_ = sc_core::SC_ZERO_TIME;
  product_ = 0;
}

void PhaseEngine::copy_x() {
  copied_ = sc_core::sc_time_stamp() + static_cast<double>(phases_.writing_direction) * period_;
}

void PhaseEngine::start_solve(const fixed::Settings& settings, const fixed::Report& report) {
  require_supported(settings);
  settings_ = settings;
  report_ = report;
  loop_ = 0;
  free_at_ = {};
  held_ = {};
  state_clocks_ = {};
  // The copy may end between two of the job's clocks; they begin with its end.
  const sc_core::sc_time& now = sc_core::sc_time_stamp();
  const sc_core::sc_time wait = copied_ > now ? copied_ - now : sc_core::SC_ZERO_TIME;
  const auto period = period_.value();
  clock_ = static_cast<std::int64_t>((wait.value() + period - 1) / period);
  hold(settings.start == fixed::Start::extrapolated ? State::guess : State::start_product, wait);
}

void PhaseEngine::abort() {
  over_.cancel();
  state_ = State::idle;
  copied_ = sc_core::SC_ZERO_TIME;
  product_ = 0;
}

// The residual is formed anew in this iteration. Once nothing is left to do it never is.
bool PhaseEngine::replaces() const {
  const int every = settings_.replace_residual_every;
  return every > 0 && loop_ <= report_.iterations && loop_ % every == 0;
}

State PhaseEngine::next() const {
  switch (state_) {
    case State::guess:
      return State::start_product;
    case State::start_product:
      return State::start_residual;
    case State::start_residual:
      return State::first_direction;
    case State::first_direction:
    case State::direction: {
      const bool ends =
          loop_ == settings_.iterations || (report_.reached && loop_ == report_.iterations);
      return ends ? State::idle : State::product;
    }
    case State::product:
      // dᵀA·d came out at or below zero.
      return report_.breakdowns > 0 && loop_ > report_.iterations ? State::idle : State::alpha;
    case State::alpha:
      return State::update;
    case State::update:
      return replaces() ? State::anew_product : State::beta;
    case State::anew_product:
      return State::anew_residual;
    case State::anew_residual:
      return State::beta;
    case State::beta:
      return State::direction;
    case State::copy:
    case State::idle:
      break;
  }
  return State::idle;
}

void PhaseEngine::advance() {
  const State following = next();
  if (following == State::idle) {
    state_ = State::idle;
    copy_x();
    done_.notify(sc_core::SC_ZERO_TIME);
    return;
  }
  if (following == State::product) ++loop_;
  hold(following);
}

void PhaseEngine::hold(State state, const sc_core::sc_time& after) {
  const auto phase = [&]() -> EnginePhase {
    // Command and quotient stand in registers.
    const std::int64_t division = std::max<std::int64_t>(
        2, std::int64_t{architecture_.division_clocks} * settings_.scalar_bits / 64);
    switch (state) {
      case State::guess:
      case State::first_direction:
        return {phases_.writing_direction, kVectorsAndDirection};
      case State::start_residual:
        return {phases_.vectors, kVectors};
      case State::product:
      case State::start_product:
      case State::anew_product:
        return {phases_.products.clocks[product_], kProduct};
      case State::alpha:
      case State::beta:
        return {division, kDivider};
      case State::update:
        return {replaces() ? phases_.moving_direction : phases_.reading_direction,
                kVectorsAndDirection};
      case State::anew_residual:
      case State::direction:
        return {phases_.moving_direction, kVectorsAndDirection};
      case State::copy:
      case State::idle:
        break;
    }
    return {};
  }();
  state_ = state;
  if (phase.units == kProduct) product_ = phases_.products.after(product_);
  std::int64_t begin = clock_;  // what it needs is there
  for (std::size_t u = 0; u < free_at_.size(); ++u) {
    if ((phase.units >> u & 1U) != 0) begin = std::max(begin, free_at_[u]);
  }
  const std::int64_t end = begin + phase.clocks;
  for (std::size_t u = 0; u < free_at_.size(); ++u) {
    if ((phase.units >> u & 1U) == 0) continue;
    free_at_[u] = end;
    held_[u] += phase.clocks;
  }
  if (phase_begun) phase_begun(state);
  over_.notify(after + static_cast<double>(end - clock_) * period_);
  state_clocks_[static_cast<std::size_t>(state)] += end - clock_;
  clock_ = end;
}

}  // namespace hvp::vp::engine
