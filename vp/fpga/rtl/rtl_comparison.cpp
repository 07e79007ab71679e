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

// The RTL engine gets so many clocks more to come to its end, for the difference to be named.
constexpr std::int64_t kPatience = 100'000;

std::int64_t solve_clocks(const engine::StateClocks& clocks) {
  return std::accumulate(clocks.begin() + kFirstState, clocks.end(), std::int64_t{0});
}

// The flags of the diagonal are found when the matrix is loaded; a breakdown is counted beside its
// flag.
stability::Flags of_hardware(stability::Flags flags) {
  using stability::Flag;
  return flags.without(Flag::zero_diagonal).without(Flag::negative_curvature);
}

std::int64_t in_ps(const sc_core::sc_time& time) { return static_cast<std::int64_t>(time.value()); }
std::int64_t now_ps() { return in_ps(sc_core::sc_time_stamp()); }

}  // namespace

void RtlComparison::load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) {
  solving_ = false;
  waits_ = false;
  b_.clear();
  index_flips_.clear();
  rtl_.load(matrix, settings);
}

void RtlComparison::open_waveform(const std::string& path, const engine::TraceWindow& window) {
  waveform_ = std::make_unique<RtlWaveform>(rtl_, engine_.name(), path, window, period_ps());
}

void RtlComparison::close_waveform() {
  if (!waveform_) return;
  rtl_.end_copy();
  waveform_->close();
  waveform_.reset();
}

std::int64_t RtlComparison::period_ps() const { return in_ps(engine_.clock().period()); }

void RtlComparison::begin_copy(const sc_core::sc_time& from) {
  copied_from_ = from;
  if (waveform_) waveform_->begin_copy(in_ps(from));
}

// A host's write ends the copy in RTL. While it has clocks left, in which bits of it may flip, the
// words wait for its end.
void RtlComparison::write_b(std::span<const std::int32_t> words) {
  if (expects_flips_ && difference_.empty()) catch_up();
  if (rtl_.copying()) {
    b_.assign(words.begin(), words.end());
  } else {
    b_.clear();
    rtl_.write_b(words);
  }
}

void RtlComparison::write_x(std::span<const std::int32_t> words) {
  rtl_.end_copy();
  begin_copy(sc_core::sc_time_stamp());
  rtl_.write_x(words);
  if (!expects_flips_) rtl_.end_copy();
}

std::int64_t RtlComparison::edges_since(const sc_core::sc_time& time) const {
  return (now_ps() - in_ps(time)) / period_ps();
}

void RtlComparison::start_solve(const fixed::Settings& settings) {
  started_ = sc_core::sc_time_stamp();
  settings_ = settings;
  turn_waits_ = turn_waits();
  room_waits_ = room_waits();
  ++started_solves_;
  solving_ = true;
  matrix_is_compared_ = false;
  waits_ = engine_.sequencer().state() == engine::State::copy;
  solve_from_ = started_;
  waited_ = 0;
  // What a copy leaves, and what is written behind it, is not there yet.
  if (!waits_ || !rtl_.copying()) {
    const bool copies = waits_;
    begin_solve();
    compare_words(Vector::b, engine_.vector_unit().memories().b);
    compare_words(Vector::x, engine_.vector_unit().memories().x);
    if (!copies) compare_direction();
  }
}

void RtlComparison::begin_solve() {
  rtl_.end_copy();
  if (waits_) {
    const auto copied = static_cast<double>(rtl_.copy_clocks()) * engine_.clock().period();
    solve_from_ = std::max(started_, copied_from_ + copied);
    waited_ = (in_ps(solve_from_) - in_ps(started_) + period_ps() - 1) / period_ps();
  }
  waits_ = false;
  if (!b_.empty()) rtl_.write_b(b_);
  b_.clear();
  rtl_.start_solve(settings_);
  if (waveform_) {
    waveform_->set_job(started_solves_);
    waveform_->begin_order(in_ps(solve_from_), waited_);
  }
}

void RtlComparison::catch_up() {
  rtl_.run_copy_until(edges_since(copied_from_));
  if (waits_ && !rtl_.copying()) begin_solve();
  if (solving_ && !waits_) rtl_.run_until(solve_edges());
}

// Where the model's copy of x has begun, this one has made it already, as nobody else knew of its
// clocks: it makes it again, of the same words.
void RtlComparison::expect_flips() {
  if (expects_flips_) return;
  expects_flips_ = true;
  rtl_.expect_flips();
  if (solving_ || engine_.sequencer().state() != engine::State::copy) return;
  if (waveform_) waveform_->begin_copy(in_ps(copied_from_));
  rtl_.start_copy();
}

void RtlComparison::flip(const engine::Flip& flip) {
  if (!difference_.empty()) return;
  catch_up();
  using Place = engine::FlipPlace;
  if (flip.place == Place::b && !b_.empty()) {
    std::int32_t& word = b_[3 * at(flip.node) + at(flip.component)];
    word = static_cast<std::int32_t>(engine::flipped(word, flip.bit, settings_.residual_bits()));
    return;
  }
  if (flip.place >= Place::nodes && flip.place <= Place::last) index_flips_.push_back(flip);
  rtl_.flip(flip);
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
  for (int copy = 0; copy < rtl_.memories().copies(vector); ++copy) {
    compare_copy(vector, copy, model);
  }
}

void RtlComparison::compare_copy(Vector vector, int copy, std::span<const std::int32_t> model) {
  if (!difference_.empty()) return;
  const EngineMemories& memories = rtl_.memories();
  compared_.words += static_cast<std::int64_t>(model.size());
  const std::optional<std::size_t> other = memories.mismatch(vector, model, copy);
  if (!other) return;
  const auto node = static_cast<int>(*other / 3);
  const auto component = static_cast<int>(*other % 3);
  std::string what = name(vector);
  if (vector == Vector::d) {
    const int of_partition = memories.copies_in_partition();
    what += of_partition == 1 ? " in the copy" : " in copy " + std::to_string(copy % of_partition);
    what += " of partition " + std::to_string(copy / of_partition);
  }
  what += ", component " + std::to_string(component) + " of node " + std::to_string(node) + ",";
  compare(what, memories.word(vector, node, component, copy), model[*other]);
}

// A word that has flipped is that of one copy.
void RtlComparison::compare_direction() {
  if (!engine_.carries_words()) {
    compare_words(Vector::d, engine_.block(0).direction());
    return;
  }
  std::vector<std::int32_t> words(engine_.block(0).direction().size());
  const int copies = rtl_.memories().copies_in_partition();
  for (int copy = 0; copy < rtl_.memories().copies(Vector::d); ++copy) {
    const engine::SpmxvBlock& block = engine_.block(copy / copies);
    for (std::size_t i = 0; i < words.size(); ++i) {
      words[i] =
          block.direction_word(static_cast<int>(i) / 3, static_cast<int>(i) % 3, copy % copies);
    }
    compare_copy(Vector::d, copy, words);
  }
}

void RtlComparison::compare_vectors() {
  const engine::VectorMemories& model = engine_.vector_unit().memories();
  compare_words(Vector::b, model.b);
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
  if (waits_) begin_solve();
  rtl_.run_iteration(solve_edges());
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
  if (difference_.empty() && waits_) begin_solve();
  solving_ = false;
  if (!difference_.empty()) return;
  rtl_.run_until(solve_clocks(engine_.state_clocks()) + kPatience);
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
  // The engine begins to copy x at the instant of the end, and may be through by now. Rows that a
  // flipped index word has the last product leave come to q while it copies.
  const bool copies = engine_.sequencer().state() == engine::State::copy;
  const bool at_end = copies && edges_since(started_) == engine_.clocks();
  if (!expects_flips_ || at_end) compare_words(Vector::q, engine_.vector_unit().memories().q);
  compare_vectors();
  if (rtl_.settings().preconditioned()) {
    compare_words(Vector::z, engine_.vector_unit().memories().z);
  }
  compare_x();
  if (at_end) compare_direction();
  begin_copy(engine_.ended());
  rtl_.start_copy();
  if (!expects_flips_ || !copies) rtl_.end_copy();
  if (copies) return;
  if (expects_flips_) compare_words(Vector::q, engine_.vector_unit().memories().q);
  compare_direction();
}

void RtlComparison::invert() {
  compare("the number of clocks in which the matrix is taken over", rtl_.invert(),
          engine_.update_clocks());
}

// The cycle-accurate engine's editor knows the pattern that was loaded: what has flipped in the
// index words does not lead this one elsewhere.
void RtlComparison::edit(int node, const std::function<std::int64_t()>& edited, const char* what) {
  rtl_.end_copy();
  if (waveform_) waveform_->begin_order(now_ps(), 0);
  for (const engine::Flip& flip : index_flips_) rtl_.flip(flip);
  const std::int64_t clocks = edited();
  for (const engine::Flip& flip : index_flips_) rtl_.flip(flip);
  compare("the number of clocks in which node " + std::to_string(node) + " is " + what, clocks,
          engine_.update_clocks());
  ++compared_.updates;
}

void RtlComparison::constrain(int node, std::int32_t diagonal) {
  edit(
      node, [&] { return rtl_.constrain(node, diagonal); }, "constrained");
}

void RtlComparison::restore(int node, std::span<const std::int32_t> row) {
  edit(
      node, [&] { return rtl_.restore(node, row); }, "restored");
}

void RtlComparison::abort() {
  const bool copies = engine_.sequencer().state() == engine::State::copy;
  if (difference_.empty() && (expects_flips_ || !copies)) catch_up();
  const bool compares = solving_ && !waits_ && difference_.empty() && !copies;
  if (compares) {
    ++compared_.aborted;
    compared_.iterations += rtl_.ports().iterations_made;
    compared_.clocks += rtl_.clocks();
    // Before an iteration some words are those of the job before, or of nobody.
    if (rtl_.ports().iterations_made > 0) {
      compare_words(Vector::q, engine_.vector_unit().memories().q);
      compare_vectors();
      // A memory with two ports takes a word of d a clock after the model.
      const bool at_once =
          engine_.architecture().direction_memory == accel::DirectionMemory::double_pumped;
      if (at_once) compare_direction();
    }
  }
  solving_ = false;
  waits_ = false;
  b_.clear();
  rtl_.abort();
  if (compares) compare_x();
}

}  // namespace hvp::vp::rtl
