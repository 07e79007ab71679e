// Jobs: a solve from its command to its results, and a list with a solve in it.
#include <algorithm>
#include <utility>

#include <spdlog/spdlog.h>

#include "models/config/input_error.h"
#include "models/fixed/solver.h"
#include "models/fixed/word.h"
#include "vp/fpga/accelerator.h"
#include "vp/fpga/board_registers.h"
#include "vp/fpga/register_bank.h"

namespace hvp::vp {

namespace {
std::uint32_t saturated(std::int64_t value) {
  return static_cast<std::uint32_t>(std::min<std::int64_t>(value, 0xffffffff));
}
}  // namespace

void Accelerator::begin(Running what, const Tag& tag) {
  running_ = what;
  started_ = now_ps();
  job_tag_ = tag;
  bank_.set(field::kStatusBusy, 1);
}

// Without clocks the timing tells of the end.
void Accelerator::end_after(std::optional<std::int64_t> clocks) {
  if (!clocks) return;
  clocks_ = *clocks;
  done_.notify(to_sc_time(*clocks * clock_period_));
}

// The job is computed; how long it takes depends on the level.
void Accelerator::begin_solve(const Tag& tag) {
  const bool stuck = strikes(FaultKind::stuck_busy);
  begin(Running::solve, tag);
  if (strikes(FaultKind::function_level_reset)) {
    power_on();
    return;
  }
  plan_flips();
  if (stuck) {
    if (listed_) dma_->abort();  // there is no end; nor does the engine do anything more
  } else if (fault_) {
    end_after(1);  // there is nothing to wait for
  } else {
    end_after(timing_->start_solve(settings_, result_));
  }
}

// The words of the engine's pipelines are those that software reads.
void Accelerator::take_engine_words() {
  if (fault_) return;
  if (const std::optional<SolveClocks> engine = timing_->solve_clocks()) {
    clocks_ = engine->clocks;
    if (!longest_solve_ || longest_solve_->clocks < clocks_) {
      longest_solve_ = EngineSolve{*engine, accel::solve_made(settings_, result_)};
    }
  }
  const bool confirmed = timing_->confirms(u_);
  if (flipped_ != nullptr) take_flipped_words();
  if (confirmed || flipped_ != nullptr) return;
  spdlog::error("the engine's words are not those of the solver");
  fault_ = true;
}

// Reads the settings of the job; a refused start does not count as one.
bool Accelerator::may_start() {
  if (bank_.get(field::kStatusMatrixLoaded) == 0) {
    raise({ErrorCode::not_loaded, 0});
    return false;
  }
  if (const BoardError error = read_settings(bank_, settings_); error.code != ErrorCode::none) {
    raise(error);
    return false;
  }
  return supported(settings_);
}

void Accelerator::start() {
  if (!may_start()) return;
  bank_.set(field::kJobJob, bank_.get(field::kJobJob) + 1);
  compute();
  begin_solve(*commanding_tag_);
}

BoardError Accelerator::check_list() const {
  const auto misaligned = [this](Register low) {
    return bank_.get(low) % (4 * kDescriptorWords) != 0;
  };
  const std::uint32_t most = bank_.get(field::kCapabilityDmaMaxDescriptors);
  if (most == 0) return bad_setting(field::kCapabilityDmaMaxDescriptors);
  if (bank_.get(field::kDmaCountToBoard) + bank_.get(field::kDmaCountToHost) > most) {
    return bad_setting(field::kDmaCountToBoard);
  }
  if (misaligned(Register::dma_list_low)) return bad_setting(field::kDmaListLowLow);
  if (misaligned(Register::dma_record_low)) return bad_setting(field::kDmaRecordLowLow);
  return {};
}

void Accelerator::run_list() {
  bank_.set(field::kInterruptStatusDone, 0);
  mirror_status();
  drive_interrupt_line(*commanding_tag_);
  if (const BoardError error = check_list(); error.code != ErrorCode::none) {
    raise(error);
    return;
  }
  if (!may_start()) return;
  bank_.set(field::kJobJob, bank_.get(field::kJobJob) + 1);
  bank_.set(field::kStatusBusy, 1);
  listed_ = true;
  job_tag_ = *commanding_tag_;
  dma_->ring(job_tag_);
}

// From here to the end there is no matrix, so that nobody solves with half of one.
void Accelerator::fetch_values() {
  if (bank_.get(field::kCapabilityDmaMaxDescriptors) == 0) {
    raise(bad_setting(field::kCapabilityDmaMaxDescriptors));
    return;
  }
  if (bank_.get(Register::dma_values_low) % kDescriptorBytes != 0) {
    raise(bad_setting(field::kDmaValuesLowLow));
    return;
  }
  fixed::Settings settings;
  if (!may_renew(settings)) return;
  bank_.set(field::kStatusMatrixLoaded, 0);
  bank_.set(field::kStatusBusy, 1);
  job_tag_ = *commanding_tag_;
  dma_->fetch_values(job_tag_);
}

void Accelerator::values_fetched(const BoardError& error, const Tag& tag) {
  job_tag_ = tag;
  BoardError found = error;
  if (found.code == ErrorCode::none) found = read_values(bank_, matrix_);
  if (found.code != ErrorCode::none) {
    end_job(found);
    return;
  }
  // The settings have been checked, and are locked since.
  fixed::Settings settings;
  read_settings(bank_, settings);
  renew(settings, tag);
}

void Accelerator::solve_listed(const Tag& tag) {
  compute();
  begin_solve(tag);
}

// STATUS as it will read when the list has ended.
CompletionRecord Accelerator::completion(const BoardError& error, const ListBytes& moved) const {
  std::uint32_t status = bank_.get(Register::status) & ~field::kStatusBusy.mask();
  if (error.code == ErrorCode::none) {
    status |= field::kStatusDone.mask();
  } else if (bank_.get(field::kStatusError) == 0) {
    status |= field::kStatusError.mask() | static_cast<std::uint32_t>(error.code)
                                               << field::kStatusErrorCode.low;
  }
  return {status,
          moved.to_board,
          moved.to_host,
          bank_.get(field::kResultIterationsCount),
          bank_.get(field::kResultFlagsBits),
          bank_.get(field::kResultCyclesLowLow),
          bank_.get(field::kResultCyclesHighHigh),
          bank_.get(field::kJobJob)};
}

void Accelerator::list_ended(const BoardError& error, bool whole, const Tag& tag) {
  listed_ = false;
  job_tag_ = tag;
  end_job(error, whole);
}

// Ends a job or a load, as far as software sees it.
void Accelerator::end_job(const BoardError& error, bool whole) {
  bank_.set(field::kStatusBusy, 0);
  job_end_ = {job_tag_, now_ps(), whole ? HVP_OK : HVP_ERROR_SHORT_TRANSFER};
  // The first error since the last one was acknowledged is the one that software reads.
  const std::uint32_t pending = bank_.get(field::kErrorCode);
  const std::uint32_t code = pending != 0 ? pending : static_cast<std::uint32_t>(error.code);
  if (code != 0) job_end_.status = hvp_status_of_board(code);
  if (error.code != ErrorCode::none) {
    raise(error);
    return;
  }
  bank_.set(field::kInterruptStatusDone, 1);
  mirror_status();
  drive_interrupt_line(job_tag_);
}

void Accelerator::finish() {
  if (running_ == Running::nothing) return;  // given up at this instant
  // A job that nobody waited for any more belongs to no frame.
  if (!ledger_.has(job_tag_.frame)) job_tag_ = {};
  const Running ended = std::exchange(running_, Running::nothing);
  if (ended != Running::solve) {
    if (ended == Running::update) {
      ledger_.extend(job_tag_, Part::fpga, Phase::load_values, started_, now_ps());
    }
    bank_.set(field::kStatusMatrixLoaded, 1);
    bank_.set(field::kStatusPatternLoaded, 1);
    end_job({});
    return;
  }
  ledger_.extend(job_tag_, Part::fpga, Phase::solve, started_, now_ps());
  take_engine_words();
  if (!fault_) publish();
  const BoardError error{fault_ ? ErrorCode::internal_fault : ErrorCode::none, 0};
  if (listed_) {
    dma_->solved(job_tag_, error);
  } else {
    end_job(error);
  }
}

// U as the job starts from it, in u_.
void Accelerator::form_guess(fixed::Start start) {
  const unsigned vector_bits = bank_.get(field::kFormatVectorBits);
  const std::span<const std::uint32_t> words = bank_.memory(Aperture::u);
  for (std::size_t i = 0; i < u_.size(); ++i) {
    u_[i] = start == fixed::Start::zero ? 0 : packed_element(words, i, vector_bits, one_a_word());
  }
  result_ = {};
  if (start != fixed::Start::extrapolated) {
    has_previous_u_ = false;
    return;
  }
  if (has_previous_u_) {
    result_.saturations = fixed::extrapolate(u_, previous_u_, settings_.vector_bits);
  } else {
    previous_u_ = u_;
    has_previous_u_ = true;
  }
}

void Accelerator::require_solver(const fixed::Settings& settings) {
  fixed::Settings wanted = settings;
  wanted.start = fixed::Start::warm;
  if (solver_ != nullptr && wanted == solver_settings_) return;
  solver_settings_ = wanted;
  solver_ = fixed::make_solver(solver_settings_);
  solver_->load(matrix_);
}

// The job that starts now, into u_ and result_. Nothing of it is visible yet.
void Accelerator::compute() {
  if (numbers_ == Numbers::none) {
    result_ = {};
    result_.iterations = settings_.iterations;
    result_.replacements = accel::longest_solve(settings_).replacements;
    fault_ = false;
    return;
  }
  const unsigned rhs_bits = bank_.get(field::kFormatRhsBits);
  const std::span<const std::uint32_t> words = bank_.memory(Aperture::b);
  for (std::size_t i = 0; i < b_.size(); ++i) {
    b_[i] = packed_element(words, i, rhs_bits, one_a_word());
  }
  if (strikes(FaultKind::saturated_solve)) {
    std::ranges::fill(b_, static_cast<std::int32_t>(fixed::word_limit(static_cast<int>(rhs_bits))));
  }
  form_guess(settings_.start);
  const std::int64_t clamped = result_.saturations;
  timing_->write_b(b_);
  // Through the driver's frames nothing may be thrown.
  try {
    require_solver(settings_);
    result_ = solver_->solve({b_, u_});
    fault_ = false;
  } catch (const InputError& e) {
    spdlog::warn("the board's solver stopped: {}", e.what());
    solver_.reset();
    has_previous_u_ = false;
    timing_->forget_previous();
    fault_ = true;
  }
  result_.saturations += clamped;
  if (clamped > 0) result_.flags.raise(stability::Flag::saturation);
}

void Accelerator::publish() {
  report_ = result_;
  saturations_ += report_.saturations;
  wraps_ += report_.wraps;
  breakdowns_ += report_.breakdowns;
  if (job_tag_.frame >= 0) ledger_.frame(job_tag_.frame).saturations += report_.saturations;
  if (numbers_ == Numbers::fixed) {
    const unsigned vector_bits = bank_.get(field::kFormatVectorBits);
    const std::span<std::uint32_t> words = bank_.memory(Aperture::u);
    for (std::size_t i = 0; i < u_.size(); ++i) {
      set_packed_element(words, i, vector_bits, u_[i], one_a_word());
    }
  }
  bank_.set(field::kResultJobJob, bank_.get(field::kJobJob));
  bank_.set(field::kResultIterationsCount, static_cast<std::uint32_t>(report_.iterations));
  bank_.set(field::kResultEndReached, report_.reached ? 1 : 0);
  bank_.set(field::kResultReplacementsCount, static_cast<std::uint32_t>(report_.replacements));
  bank_.set(field::kResultSaturationsCount, saturated(report_.saturations));
  bank_.set(field::kResultWrapsCount, saturated(report_.wraps));
  bank_.set(field::kResultBreakdownsCount, saturated(report_.breakdowns));
  bank_.set(field::kResultFlagsBits, report_.flags.bits());
  bank_.set(field::kStatusFlags, report_.flags.bits());
  const auto clocks = static_cast<std::uint64_t>(clocks_);
  bank_.set(field::kResultCyclesLowLow, static_cast<std::uint32_t>(clocks));
  bank_.set(field::kResultCyclesHighHigh, static_cast<std::uint32_t>(clocks >> 32));
}

}  // namespace hvp::vp
