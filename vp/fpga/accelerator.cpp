#include "vp/fpga/accelerator.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <spdlog/spdlog.h>

#include "models/config/input_error.h"
#include "models/fixed/kernel.h"
#include "models/fixed/start_guess.h"
#include "models/fixed/word.h"
#include "vp/fpga/board_settings.h"
#include "vp/fpga/packed_words.h"

namespace hvp::vp {

namespace {

std::uint32_t offset_of(Register reg) { return kRegisters[static_cast<std::size_t>(reg)].offset; }

tlm::tlm_response_status response(Access access) {
  switch (access) {
    case Access::ok:
      return tlm::TLM_OK_RESPONSE;
    case Access::unmapped:
      return tlm::TLM_ADDRESS_ERROR_RESPONSE;
    case Access::misaligned:
      return tlm::TLM_BURST_ERROR_RESPONSE;
    case Access::read_only:
    case Access::write_only:
    case Access::busy:
      break;
  }
  return tlm::TLM_COMMAND_ERROR_RESPONSE;
}

std::uint32_t saturated(std::int64_t value) {
  return static_cast<std::uint32_t>(std::min<std::int64_t>(value, 0xffffffff));
}

}  // namespace

Accelerator::Accelerator(const sc_core::sc_module_name& name,
                         const accel::Architecture& architecture, Timing level, Ledger& ledger,
                         AccessObserver* observer, Numbers numbers, const MasterSettings& master)
    : sc_module(name),
      from_bus("from_bus"),
      interrupt("interrupt"),
      architecture_(architecture),
      level_(level),
      numbers_(numbers),
      ledger_(ledger),
      observer_(observer),
      done_("done") {
  if (numbers == Numbers::none && level == Timing::cycle_accurate) {
    throw InputError("numbers", "the cycle-accurate engine makes the words: expected \"fixed\"");
  }
  from_bus.register_b_transport(this, &Accelerator::b_transport);
  strap_capability(bank_);
  bank_.strap(Register::capability_clock,
              static_cast<std::uint32_t>(std::llround(architecture.clock_hz / 1000)));
  bank_.on_write(Register::control,
                 [this](std::uint32_t written, std::uint32_t /*before*/) { control(written); });
  for (const Register reg : {Register::interrupt_status, Register::interrupt_enable}) {
    bank_.on_write(reg, [this](std::uint32_t /*written*/, std::uint32_t /*before*/) {
      mirror_status();
      drive_interrupt_line(*commanding_tag_);
    });
  }
  for (const Register reg :
       {Register::method, Register::format, Register::nodes, Register::blocks, Register::packing}) {
    bank_.on_write(reg, [this, reg](std::uint32_t /*written*/, std::uint32_t before) {
      if (bank_.get(reg) != before) bank_.set(field::kStatusMatrixLoaded, 0);
    });
  }
  for (const Aperture aperture : {Aperture::row_begin, Aperture::column, Aperture::value}) {
    bank_.on_memory_write(aperture, [this] { bank_.set(field::kStatusMatrixLoaded, 0); });
  }
  bank_.on_memory_write(Aperture::u, [this] {
    has_previous_u_ = false;
    give_engine_x();
  });
  if (master.present()) {
    dma_ = std::make_unique<DmaEngine>("dma", master, level == Timing::untimed, bank_,
                                       static_cast<ListOwner&>(*this), ledger);
    if (dma_->has_lists()) bank_.strap(Register::capability_dma, DmaEngine::kMaxDescriptors);
  }
  SC_HAS_PROCESS(Accelerator);
  SC_METHOD(finish);
  sensitive << done_;
  dont_initialize();
  if (level == Timing::approximately_timed) {
    phases_ = std::make_unique<engine::PhaseEngine>("phases", architecture);
    sensitive << phases_->done();
  } else if (level == Timing::cycle_accurate) {
    cycles_ = std::make_unique<engine::CycleEngine>("engine", architecture);
    sensitive << cycles_->done();
  }
}

void Accelerator::inject(FaultPlan& plan) {
  faults_ = &plan;
  if (dma_ != nullptr) dma_->inject(plan);
}

void Accelerator::require_supported(Timing level, const fixed::Settings& settings) {
  if (has_engine(level)) engine::require_supported(settings);
}

// A job is refused where its level does not have the method.
bool Accelerator::supported(const fixed::Settings& settings) {
  try {
    require_supported(level_, settings);
    return true;
  } catch (const InputError& e) {
    spdlog::warn("the board refused a setting: {}", e.what());
    raise({ErrorCode::bad_setting, offset_of(Register::method)});
    return false;
  }
}

void Accelerator::b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
  // A job that ends at the instant of an access has ended, whatever the kernel runs first.
  if (running_ != Running::nothing) wait(sc_core::SC_ZERO_TIME);
  Tag none;
  commanding_tag_ = &tag_of(transaction, none);
  wait_states_ = 0;
  const std::uint64_t offset = transaction.get_address();
  const std::span<std::uint8_t> data(transaction.get_data_ptr(), transaction.get_data_length());
  const Command command = transaction.is_read() ? Command::read : Command::write;
  const Outcome outcome =
      command == Command::read ? bank_.read(offset, data) : bank_.write(offset, data);
  transaction.set_response_status(response(outcome.access));
  if (observer_ != nullptr) observer_->access(now_ps(), command, bank_, outcome, offset, data);
  if (!outcome.ok()) {
    ++illegal_accesses_;
    spdlog::warn("{} at {} ns", bank_.describe(outcome, command),
                 static_cast<double>(now_ps()) * 1e-3);
    raise({ErrorCode::illegal_access, static_cast<std::uint32_t>(outcome.offset)});
  }
  commanding_tag_ = nullptr;
  delay += to_sc_time(wait_states_);
}

void Accelerator::control(std::uint32_t commands) {
  const auto given = [commands](Field command) { return (commands & command.mask()) != 0; };
  if (given(field::kControlReset)) {
    reset();
    return;
  }
  if (bank_.get(field::kInterruptStatusError) != 0) return;
  frame_ = commanding_tag_->frame;
  if (given(field::kControlStart)) {
    start();
  } else if (given(field::kControlRunList)) {
    run_list();
  } else if (given(field::kControlLoadDone)) {
    load_done();
  } else if (given(field::kControlUpdateNode)) {
    update_node();
  }
}

void Accelerator::begin(Running what, const Tag& tag) {
  running_ = what;
  started_ = now_ps();
  job_tag_ = tag;
  bank_.set(field::kStatusBusy, 1);
}

void Accelerator::run_for(Running what, const Tag& tag, std::int64_t clocks) {
  begin(what, tag);
  clocks_ = clocks;
  const bool untimed = level_ == Timing::untimed;
  done_.notify(to_sc_time(untimed ? 0 : clocks * architecture_.clock_period_ps()));
}

// The job is computed; who says how long it takes depends on the level.
void Accelerator::begin_solve(const Tag& tag) {
  if (strikes(FaultKind::stuck_busy)) {
    begin(Running::solve, tag);  // and no end; nor does the engine do anything more
    if (listed_) dma_->abort();
  } else if (fault_) {
    run_for(Running::solve, tag, 1);  // there is nothing to wait for
  } else if (cycles_ != nullptr) {
    begin(Running::solve, tag);
    cycles_->start_solve(settings_);
  } else if (phases_ != nullptr) {
    begin(Running::solve, tag);
    phases_->start_solve(settings_, result_);
  } else {
    const accel::SolveWork work = accel::solve_made(settings_, result_);
    run_for(Running::solve, tag, loosely_timed_->solve(work).total());
  }
}

// What the engine's pipelines have put out is what software reads.
void Accelerator::take_engine_words() {
  if (fault_) return;
  if (phases_ != nullptr) {
    clocks_ = phases_->clocks();
    note_engine_clocks(phases_->state_clocks());
  }
  if (cycles_ == nullptr) return;
  clocks_ = cycles_->clocks();
  note_engine_clocks(cycles_->state_clocks());
  engine_u_.resize(u_.size());
  cycles_->read_x(engine_u_);
  if (engine_u_ == u_) return;
  spdlog::error("the engine's words are not those of the solver");
  fault_ = true;
}

void Accelerator::note_engine_clocks(const engine::StateClocks& state) {
  if (longest_solve_ && longest_solve_->clocks >= clocks_) return;
  longest_solve_ = {accel::solve_made(settings_, result_), clocks_, state};
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
  const auto bad = [](Register reg) { return BoardError{ErrorCode::bad_setting, offset_of(reg)}; };
  const auto misaligned = [this](Register low) {
    return bank_.get(low) % (4 * kDescriptorWords) != 0;
  };
  const std::uint32_t most = bank_.get(field::kCapabilityDmaMaxDescriptors);
  if (most == 0) return bad(Register::capability_dma);
  if (bank_.get(field::kDmaCountToBoard) + bank_.get(field::kDmaCountToHost) > most) {
    return bad(Register::dma_count);
  }
  if (misaligned(Register::dma_list_low)) return bad(Register::dma_list_low);
  if (misaligned(Register::dma_record_low)) return bad(Register::dma_record_low);
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

void Accelerator::list_ended(const BoardError& error, const Tag& tag) {
  listed_ = false;
  job_tag_ = tag;
  end_job(error);
}

// What software sees of the end of a job or of a load.
void Accelerator::end_job(const BoardError& error) {
  bank_.set(field::kStatusBusy, 0);
  job_end_ = {job_tag_, now_ps()};
  if (error.code != ErrorCode::none) {
    raise(error);
    return;
  }
  bank_.set(field::kInterruptStatusDone, 1);
  mirror_status();
  drive_interrupt_line(job_tag_);
}

void Accelerator::load_done() {
  fixed::Settings settings;
  BoardError error = read_settings(bank_, settings);
  if (error.code == ErrorCode::none) error = read_matrix(bank_, matrix_);
  if (error.code != ErrorCode::none) {
    raise(error);
    return;
  }
  if (!supported(settings) || !load_engine(settings)) return;
  solver_.reset();
  loaded_method_ = settings.method;
  has_previous_u_ = false;
  b_.assign(static_cast<std::size_t>(matrix_.rows()), 0);
  u_.assign(static_cast<std::size_t>(matrix_.rows()), 0);
  give_engine_x();
  if (cycles_ != nullptr) {
    begin(Running::load, *commanding_tag_);
    cycles_->start_inversion();
  } else {
    run_for(Running::load, *commanding_tag_, loosely_timed_->load(settings.method));
  }
}

// How the matrix lies in the memories. Through the driver's frames nothing may be thrown.
bool Accelerator::load_engine(const fixed::Settings& settings) {
  try {
    if (phases_ != nullptr) phases_->load(matrix_, settings);
    if (cycles_ != nullptr) {
      cycles_->load(matrix_, settings);
    } else {
      loosely_timed_.emplace(architecture_, accel::pattern_of(matrix_.row_begin, matrix_.column));
    }
    return true;
  } catch (const InputError& e) {
    spdlog::warn("the board cannot hold the matrix: {}", e.what());
    raise({ErrorCode::internal_fault, 0});
    return false;
  }
}

void Accelerator::update_node() {
  if (bank_.get(field::kStatusMatrixLoaded) == 0) {
    raise({ErrorCode::not_loaded, 0});
    return;
  }
  const std::uint32_t node = bank_.get(field::kUpdateNodeNode);
  if (node >= static_cast<std::uint32_t>(matrix_.block_rows())) {
    raise({ErrorCode::bad_node, node});
    return;
  }
  const auto row = static_cast<int>(node);
  const std::span<const std::int32_t> present = matrix_.row(row);
  if (bank_.get(field::kUpdateKindKind) == static_cast<std::uint32_t>(UpdateKind::constrain)) {
    try {
      matrix_.set_contact(row, static_cast<std::int32_t>(bank_.get(field::kUpdateDiagonalValue)));
    } catch (const InputError&) {
      raise({ErrorCode::bad_setting, offset_of(Register::update_diagonal)});
      return;
    }
  } else {
    const std::size_t blocks = present.size() / 9;
    if (bank_.get(field::kUpdateBlocksCount) != blocks) {
      raise({ErrorCode::bad_row, static_cast<std::uint32_t>(blocks)});
      return;
    }
    row_.resize(present.size());
    const std::span<const std::uint32_t> staged = bank_.memory(Aperture::row);
    for (std::size_t i = 0; i < row_.size(); ++i) {
      row_[i] = packed_element(staged, i, static_cast<unsigned>(matrix_.bits), one_a_word());
    }
    matrix_.restore_row(row, row_);
  }
  if (solver_ != nullptr) solver_->update(row);
  write_back_node(matrix_, row, bank_);
  if (cycles_ != nullptr) {
    edit_engine(row);
    return;
  }

  const auto begin = static_cast<std::size_t>(matrix_.row_begin[node]);
  const auto end = static_cast<std::size_t>(matrix_.row_begin[node + 1]);
  // A matrix is loaded, so that METHOD is what it was loaded with.
  const std::int64_t clocks = loosely_timed_->node_update(
      row, std::span(matrix_.column).subspan(begin, end - begin), loaded_method_);
  hold_access(clocks);
}

// U is the engine's memory of x, which it brings into the copies of d when the host has written.
void Accelerator::give_engine_x() {
  if (u_.empty()) return;  // no matrix has been loaded
  if (phases_ != nullptr) phases_->written_x();
  if (cycles_ == nullptr) return;
  engine_u_.resize(u_.size());
  const unsigned vector_bits = bank_.get(field::kFormatVectorBits);
  const std::span<const std::uint32_t> words = bank_.memory(Aperture::u);
  for (std::size_t i = 0; i < engine_u_.size(); ++i) {
    engine_u_[i] = packed_element(words, i, vector_bits, one_a_word());
  }
  cycles_->write_x(engine_u_);
}

// The engine writes its packages while the access that gave the command is held.
void Accelerator::edit_engine(int node) {
  if (matrix_.is_contact[static_cast<std::size_t>(node)] != 0) {
    cycles_->start_constraining(node, matrix_.diagonal(3 * node));
  } else {
    cycles_->start_restoring(node, row_);
  }
  hold_access(cycles_->update_clocks());
}

void Accelerator::hold_access(std::int64_t clocks) {
  wait_states_ = level_ == Timing::untimed ? 0 : clocks * architecture_.clock_period_ps();
  ledger_.extend(*commanding_tag_, Part::fpga, Phase::node_update, now_ps(),
                 now_ps() + wait_states_);
}

void Accelerator::reset() {
  done_.cancel();
  if (phases_ != nullptr) phases_->abort();
  if (cycles_ != nullptr) cycles_->abort();
  running_ = Running::nothing;
  listed_ = false;
  if (dma_ != nullptr) dma_->abort();
  solver_.reset();
  has_previous_u_ = false;
  bank_.reset();
  drive_interrupt_line(*commanding_tag_);
}

void Accelerator::finish() {
  if (running_ == Running::nothing) return;  // given up at this instant
  // A job that nobody waited for any more belongs to no frame.
  if (!ledger_.has(job_tag_.frame)) job_tag_ = {};
  const Running ended = std::exchange(running_, Running::nothing);
  if (ended == Running::load) {
    bank_.set(field::kStatusMatrixLoaded, 1);
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
  if (cycles_ != nullptr) cycles_->write_b(b_);
  // Through the driver's frames nothing may be thrown.
  try {
    require_solver(settings_);
    result_ = solver_->solve({b_, u_});
    fault_ = false;
  } catch (const InputError& e) {
    spdlog::warn("the board's solver stopped: {}", e.what());
    solver_.reset();
    has_previous_u_ = false;
    if (cycles_ != nullptr) cycles_->forget_previous();
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

void Accelerator::raise(BoardError error) {
  if (bank_.get(field::kInterruptStatusError) == 0) {
    bank_.set(field::kErrorCode, static_cast<std::uint32_t>(error.code));
    bank_.set(field::kErrorDetailDetail, error.detail);
    bank_.set(field::kInterruptStatusError, 1);
  }
  mirror_status();
  // An access that is refused while a job runs must not make the job its own.
  drive_interrupt_line(commanding_tag_ != nullptr ? *commanding_tag_ : job_tag_);
}

void Accelerator::mirror_status() {
  if (bank_.get(field::kInterruptStatusError) == 0) {
    bank_.set(field::kErrorCode, 0);
    bank_.set(field::kErrorDetailDetail, 0);
  }
  bank_.set(field::kStatusDone, bank_.get(field::kInterruptStatusDone));
  bank_.set(field::kStatusError, bank_.get(field::kInterruptStatusError));
  bank_.set(field::kStatusErrorCode, bank_.get(field::kErrorCode));
}

void Accelerator::drive_interrupt_line(const Tag& tag) {
  const bool up =
      (bank_.get(Register::interrupt_status) & bank_.get(Register::interrupt_enable)) != 0;
  if (up == line_up_) return;
  line_up_ = up;
  if (dma_ != nullptr && dma_->sends_messages()) {
    if (up) dma_->send_message(tag);
    return;
  }
  if (interrupt.size() == 0) return;
  if (up) {
    interrupt->interrupt(tag);
  } else {
    interrupt->lowered();
  }
}

}  // namespace hvp::vp
