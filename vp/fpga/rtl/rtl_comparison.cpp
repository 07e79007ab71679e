#include "vp/fpga/rtl/rtl_comparison.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <optional>

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

std::int64_t now_ps() { return static_cast<std::int64_t>(sc_core::sc_time_stamp().value()); }

}  // namespace

void RtlComparison::load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) {
  solving_ = false;
  rtl_.load(matrix, settings);
}

void RtlComparison::open_waveform(const std::string& path, const engine::TraceWindow& window) {
  waveform_ = std::make_unique<RtlWaveform>(rtl_, engine_.name(), path, window, period_ps());
}

std::int64_t RtlComparison::period_ps() const {
  return static_cast<std::int64_t>(engine_.clock().period().value());
}

void RtlComparison::begin_copy() {
  copied_from_ = sc_core::sc_time_stamp();
  if (waveform_) waveform_->begin_copy(now_ps());
}

void RtlComparison::write_x(std::span<const std::int32_t> words) {
  begin_copy();
  rtl_.write_x(words);
}

std::int64_t RtlComparison::edges_since(const sc_core::sc_time& time) const {
  const sc_core::sc_time passed = sc_core::sc_time_stamp() - time;
  return static_cast<std::int64_t>(passed.value()) / period_ps();
}

void RtlComparison::start_solve(const fixed::Settings& settings) {
  started_ = sc_core::sc_time_stamp();
  const bool copies = engine_.sequencer().state() == engine::State::copy;
  waited_ = copies ? rtl_.copy_clocks() - edges_since(copied_from_) : 0;
  turn_waits_ = turn_waits();
  room_waits_ = room_waits();
  rtl_.start_solve(settings);
  ++started_solves_;
  if (waveform_) {
    waveform_->set_job(started_solves_);
    waveform_->begin_order(now_ps() + waited_ * period_ps(), waited_);
  }
  solving_ = true;
  matrix_is_compared_ = false;
  compare_words(Vector::b, engine_.vector_unit().memories().b);
  compare_words(Vector::x, engine_.vector_unit().memories().x);
  if (!copies) compare_direction();
}

void RtlComparison::compare(const std::string& what, std::int64_t rtl, std::int64_t model) {
  if (rtl == model || !difference_.empty()) return;
  difference_ = what + " is " + std::to_string(rtl) + " in RTL and " + std::to_string(model) +
                " in the cycle-accurate engine at clock " + std::to_string(rtl_.clocks()) +
                " of solve " + std::to_string(started_solves_) + ", iteration " +
                std::to_string(rtl_.ports().iterations_made);
}

void RtlComparison::compare_words(Vector vector, std::span<const std::int32_t> model) {
  if (!difference_.empty()) return;
  const EngineMemories& memories = rtl_.memories();
  for (int copy = 0; copy < memories.copies(vector); ++copy) {
    compared_.words += static_cast<std::int64_t>(model.size());
    const std::optional<std::size_t> other = memories.mismatch(vector, model, copy);
    if (!other) continue;
    const auto node = static_cast<int>(*other / 3);
    const auto component = static_cast<int>(*other % 3);
    std::string what = name(vector);
    if (vector == Vector::d) {
      const int of_partition = memories.copies_in_partition();
      what +=
          of_partition == 1 ? " in the copy" : " in copy " + std::to_string(copy % of_partition);
      what += " of partition " + std::to_string(copy / of_partition);
    }
    what += ", component " + std::to_string(component) + " of node " + std::to_string(node) + ",";
    compare(what, memories.word(vector, node, component, copy), model[*other]);
  }
}

void RtlComparison::compare_direction() { compare_words(Vector::d, engine_.block(0).direction()); }

void RtlComparison::compare_vectors() {
  const engine::VectorMemories& model = engine_.vector_unit().memories();
  compare_words(Vector::b, model.b);
  compare_words(Vector::q, model.q);
  compare_words(Vector::r, model.r);
  compare_words(Vector::x, model.x);
  if (rtl_.settings().start == fixed::Start::extrapolated) {
    compare_words(Vector::previous, model.previous);
  }
}

void RtlComparison::compare_matrix() {
  if (matrix_is_compared_ || !difference_.empty()) return;
  matrix_is_compared_ = true;
  const int width = engine_.architecture().package;
  for (int p = 0; p < engine_.architecture().partitions; ++p) {
    const engine::SpmxvBlock& block = engine_.block(p);
    for (int package = 0; package < block.partition().packages(); ++package) {
      const std::span<const std::int32_t> words = block.package_words(package);
      compared_.words += static_cast<std::int64_t>(words.size());
      for (int i = 0; i < 3 * width; ++i) {
        const std::int32_t rtl = rtl_.memories().entry(p, package, i / width, i % width);
        if (rtl == words[at(i)]) continue;
        compare("the matrix in row " + std::to_string(i / width) + " and column " +
                    std::to_string(i % width) + " of package " + std::to_string(package) +
                    " of partition " + std::to_string(p),
                rtl, words[at(i)]);
        return;
      }
    }
  }
}

void RtlComparison::iteration(const fixed::IterationState& state) {
  if (!difference_.empty()) return;
  rtl_.run_iteration();
  const EnginePorts& ports = rtl_.ports();
  const engine::VectorMemories& model = engine_.vector_unit().memories();
  // What depends on others comes after them, so that the first difference is the cause.
  compare("the iteration's number", ports.iterations_made, state.iteration);
  compare_matrix();
  compare_words(Vector::b, model.b);
  compare_words(Vector::q, model.q);
  compare("dᵀ·A·d", ports.d_q, static_cast<std::int64_t>(state.d_q));
  compare("the mantissa of alpha", ports.alpha, state.alpha.mantissa);
  compare("the exponent of alpha·q", ports.alpha_exponent, state.alpha.exponent);
  compare("the exponent of r", ports.r_exponent + rtl_.settings().rhs_shift(),
          state.residual_exponent);
  compare_words(Vector::r, model.r);
  compare_words(Vector::x, model.x);
  compare(rtl_.settings().preconditioned() ? "zᵀ·r" : "rᵀ·r", ports.z_r,
          static_cast<std::int64_t>(state.z_r));
  compare("the mantissa of beta", ports.beta, state.beta.mantissa);
  compare("the exponent of beta", ports.beta_exponent, state.beta.exponent);
  compare("the exponent of d less that of z", ports.d_exponent - ports.z_exponent,
          state.direction_exponent);
  compare_direction();
}

std::int64_t RtlComparison::turn_waits() const {
  std::int64_t waits = 0;
  for (int p = 0; p < engine_.architecture().partitions; ++p) {
    waits += engine_.block(p).bank_stalls();
  }
  return waits;
}

std::int64_t RtlComparison::room_waits() const {
  std::int64_t waits = 0;
  for (int p = 0; p < engine_.architecture().partitions; ++p) {
    waits += engine_.block(p).queue_stalls();
  }
  return waits;
}

void RtlComparison::compare_x() {
  const auto words = 3 * at(engine_.layout().nodes());
  x_.resize(words);
  model_x_.resize(words);
  rtl_.read_x(x_);
  engine_.read_x(model_x_);
  compared_.words += static_cast<std::int64_t>(words);
  const auto [rtl, model] = std::ranges::mismatch(x_, model_x_);
  if (rtl == x_.end()) return;
  const auto word = rtl - x_.begin();
  compare("x at the host's port, component " + std::to_string(word % 3) + " of node " +
              std::to_string(word / 3) + ",",
          *rtl, *model);
}

void RtlComparison::end_solve() {
  solving_ = false;
  if (!difference_.empty()) return;
  rtl_.run_to_end();
  ++compared_.solves;
  compared_.iterations += rtl_.ports().iterations_made;
  compared_.clocks += rtl_.clocks();
  const engine::StateClocks& rtl = rtl_.state_clocks();
  const engine::StateClocks& model = engine_.state_clocks();
  for (std::size_t i = kFirstState; i < rtl.size(); ++i) {
    compare(std::string("the number of clocks in the state ") +
                engine::name(static_cast<engine::State>(i)),
            rtl[i], model[i]);
  }
  compare("the number of clocks", rtl_.clocks(), solve_clocks(model));
  compare("the number of clocks in which packages wait for their turns", rtl_.ports().turn_waits,
          turn_waits() - turn_waits_);
  compare("the number of clocks in which packages wait for room", rtl_.ports().room_waits,
          room_waits() - room_waits_);
  const fixed::Report is = rtl_.report();
  const fixed::Report should = engine_.report();
  compare("the number of iterations", is.iterations, should.iterations);
  compare("the end by the stop test", is.reached ? 1 : 0, should.reached ? 1 : 0);
  compare("the number of residuals formed anew", is.replacements, should.replacements);
  compare("the number of clamped words", is.saturations, should.saturations);
  compare("the number of breakdowns", is.breakdowns, should.breakdowns);
  compare("the set of flags", of_hardware(is.flags).bits(), of_hardware(should.flags).bits());
  compare_matrix();
  compare_vectors();
  if (rtl_.settings().preconditioned()) {
    compare_words(Vector::z, engine_.vector_unit().memories().z);
  }
  compare_x();
  // The engine begins to copy x at the instant of the end, and may be through by now.
  const bool copies = engine_.sequencer().state() == engine::State::copy;
  if (copies && edges_since(started_) == engine_.clocks()) compare_direction();
  begin_copy();
  rtl_.copy_x();
  if (!copies) compare_direction();
}

void RtlComparison::invert() {
  compare("the number of clocks in which the matrix is taken over", rtl_.invert(),
          engine_.update_clocks());
}

void RtlComparison::constrain(int node, std::int32_t diagonal) {
  if (waveform_) waveform_->begin_order(now_ps(), 0);
  compare("the number of clocks in which node " + std::to_string(node) + " is constrained",
          rtl_.constrain(node, diagonal), engine_.update_clocks());
  ++compared_.updates;
}

void RtlComparison::restore(int node, std::span<const std::int32_t> row) {
  if (waveform_) waveform_->begin_order(now_ps(), 0);
  compare("the number of clocks in which node " + std::to_string(node) + " is restored",
          rtl_.restore(node, row), engine_.update_clocks());
  ++compared_.updates;
}

void RtlComparison::abort() {
  const bool compares =
      solving_ && difference_.empty() && engine_.sequencer().state() != engine::State::copy;
  if (compares) {
    rtl_.run_until(edges_since(started_) - waited_);
    ++compared_.aborted;
    compared_.iterations += rtl_.ports().iterations_made;
    compared_.clocks += rtl_.clocks();
    // Before an iteration some words are those of the job before, or of nobody.
    if (rtl_.ports().iterations_made > 0) {
      compare_vectors();
      // A memory with two ports takes a word of d a clock after the model.
      const bool at_once =
          engine_.architecture().direction_memory == accel::DirectionMemory::double_pumped;
      if (at_once) compare_direction();
    }
  }
  solving_ = false;
  rtl_.abort();
  if (compares) compare_x();
}

}  // namespace hvp::vp::rtl
