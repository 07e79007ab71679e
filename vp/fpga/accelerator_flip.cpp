// Bits of the engine's memories and registers that flip, and what comes of them.
#include <algorithm>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "models/accel/board.h"
#include "models/index.h"
#include "vp/fpga/accelerator.h"
#include "vp/fpga/board_registers.h"
#include "vp/fpga/register_bank.h"

namespace hvp::vp {

// The flips of the job that starts now, each half a clock behind its edge. From the first one on
// the engine's pipelines carry their words.
void Accelerator::plan_flips() {
  unread_flip_.reset();
  if (faults_ == nullptr) return;
  while (const Fault* const fault = faults_->strike(FaultKind::flip, frame_)) {
    engine::Flip flip = fault->flip;
    if (!complete(flip, *fault)) {
      faults_->retract(*fault);
      continue;
    }
    std::int64_t clock = fault->clock;
    if (clock < 0) {
      const accel::BoardClocks clocks(architecture_,
                                      accel::pattern_of(matrix_.row_begin, matrix_.column));
      const std::int64_t solve = clocks.solve(accel::longest_solve(settings_)).total();
      clock = faults_->choose(*fault, frame_, 0, solve);
    }
    expect_flips();
    FlipEffect& effect = faults_->effect(*fault);
    if (effect.clock < 0) {
      effect.flip = flip;
      effect.clock = clock;
    }
    if (ledger_.has(frame_)) ++ledger_.frame(frame_).flips;
    const Picoseconds time = now_ps() + clock * clock_period_ + clock_period_ / 2;
    planned_flips_->next.push_back({time, fault, flip});
  }
  if (planned_flips_ == nullptr) return;
  std::ranges::stable_sort(planned_flips_->next, {}, &PlannedFlip::time);
  await_flip();
}

void Accelerator::await_flip() {
  planned_flips_->due.cancel();
  if (planned_flips_->next.empty()) return;
  planned_flips_->due.notify(to_sc_time(planned_flips_->next.front().time - now_ps()));
}

// Event and process are there from the first flip on, which may be asked for during the run.
void Accelerator::expect_flips() {
  timing_->carry_words();
  if (planned_flips_ != nullptr) return;
  planned_flips_ = std::make_unique<PlannedFlips>();
  sc_core::sc_spawn_options options;
  options.spawn_method();
  options.set_sensitivity(&planned_flips_->due);
  options.dont_initialize();
  sc_core::sc_spawn([this] { make_flips(); }, "flips", &options);
}

// Chooses what the fault does not state; false if there is no such bit.
bool Accelerator::complete(engine::Flip& flip, const Fault& fault) {
  if (timing_->engine() == nullptr) return false;
  std::uint32_t number = 0;
  for (const engine::FlipIndex& index : engine::kFlipIndices) {
    ++number;
    if (!has_index(flip.place, index.index)) continue;
    const int range = timing_->engine()->flip_range(flip, index.index);
    int& chosen = flip.*index.index;
    if (chosen < 0 && range > 0) {
      chosen = static_cast<int>(faults_->choose(fault, frame_, number, range));
    }
    if (chosen < 0 || chosen >= range) {
      faults_->effect(fault).lacking =
          range == 0 ? std::string("there is no ") + index.key
                     : std::string(index.key) + " is " + std::to_string(chosen) +
                           ", expected less than " + std::to_string(range);
      return false;
    }
  }
  return true;
}

void Accelerator::make_flips() {
  std::deque<PlannedFlip>& next = planned_flips_->next;
  while (!next.empty() && next.front().time <= now_ps()) {
    const PlannedFlip planned = next.front();
    next.pop_front();
    flipped_ = planned.fault;
    ++faults_->effect(*flipped_).flipped;
    flip_bit(planned.flip);
  }
  await_flip();
}

// What software reads as U is the engine's x, while no job makes another one. That counts as wrong
// once it is read.
void Accelerator::flip_bit(const engine::Flip& flip) {
  timing_->flip(flip);
  if (flip.place != engine::FlipPlace::x || running_ == Running::solve) return;
  const unsigned bits = bank_.get(field::kFormatVectorBits);
  const std::size_t place = 3 * at(flip.node) + at(flip.component);
  const std::span<std::uint32_t> words = bank_.memory(Aperture::u);
  const std::int32_t word = packed_element(words, place, bits, one_a_word());
  const auto other =
      static_cast<std::int32_t>(engine::flipped(word, flip.bit, static_cast<int>(bits)));
  const std::vector<std::uint32_t> before(words.begin(), words.end());
  set_packed_element(words, place, bits, other, one_a_word());
  const auto changed = std::ranges::mismatch(words, before).in1 - words.begin();
  unread_flip_ = UnreadFlip{offset_of(Aperture::u) + 4 * static_cast<std::uint64_t>(changed),
                            std::abs(static_cast<double>(other) - word)};
  // A DMA engine moves U before it tells of the job's end.
  if (bank_.get(field::kStatusBusy) != 0) note_wrong(std::exchange(unread_flip_, {})->error);
}

void Accelerator::note_read(std::uint64_t offset, std::size_t bytes) {
  if (!unread_flip_ || unread_flip_->offset < offset || unread_flip_->offset >= offset + bytes) {
    return;
  }
  note_wrong(std::exchange(unread_flip_, {})->error);
}

// A solution had words with at most this error.
void Accelerator::note_wrong(double error) {
  FlipEffect& effect = faults_->effect(*flipped_);
  ++effect.wrong;
  effect.last_wrong_frame = job_tag_.frame;
  double size = 1;
  for (const std::int32_t word : u_) size = std::max(size, std::abs(static_cast<double>(word)));
  effect.worst = std::max(effect.worst, error / size);
}

// The engine's words and report count, and those of the solver, which has begun with the same U and
// b, are what they should have been.
void Accelerator::take_flipped_words() {
  const std::vector<std::int32_t> should = u_;
  const stability::Flags should_flags = result_.flags;
  timing_->read_x(u_);
  const fixed::Report made = timing_->report();
  if (u_ == should && made.iterations == result_.iterations) return;
  result_.iterations = made.iterations;
  result_.reached = made.reached;
  result_.replacements = made.replacements;
  result_.saturations = made.saturations;
  result_.wraps = made.wraps;
  result_.breakdowns = made.breakdowns;
  result_.flags = made.flags;
  if (should == u_) return;
  FlipEffect& effect = faults_->effect(*flipped_);
  ++effect.wrong;
  effect.last_wrong_frame = job_tag_.frame;
  if ((made.flags.bits() & ~should_flags.bits()) != 0) ++effect.told;
  double error = 0;
  double size = 0;
  for (std::size_t i = 0; i < u_.size(); ++i) {
    error = std::max(error, std::abs(static_cast<double>(u_[i]) - should[i]));
    size = std::max(size, std::abs(static_cast<double>(should[i])));
  }
  effect.worst = std::max(effect.worst, error / std::max(size, 1.0));
}

}  // namespace hvp::vp
