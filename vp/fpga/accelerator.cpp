#include "vp/fpga/accelerator.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <spdlog/spdlog.h>

#include "models/config/input_error.h"
#include "models/fixed/kernel.h"
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
                         const accel::Architecture& architecture, bool untimed, Ledger& ledger,
                         AccessObserver* observer)
    : sc_module(name),
      from_bus("from_bus"),
      interrupt("interrupt"),
      architecture_(architecture),
      untimed_(untimed),
      ledger_(ledger),
      observer_(observer),
      done_("done") {
  from_bus.register_b_transport(this, &Accelerator::b_transport);
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
  for (const Register reg : {Register::format, Register::nodes, Register::blocks}) {
    bank_.on_write(reg, [this, reg](std::uint32_t /*written*/, std::uint32_t before) {
      if (bank_.get(reg) != before) bank_.set(field::kStatusMatrixLoaded, 0);
    });
  }
  for (const Aperture aperture : {Aperture::row_begin, Aperture::column, Aperture::value}) {
    bank_.on_memory_write(aperture, [this] { bank_.set(field::kStatusMatrixLoaded, 0); });
  }
  SC_HAS_PROCESS(Accelerator);
  SC_METHOD(finish);
  sensitive << done_;
  dont_initialize();
}

void Accelerator::b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
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
  if (given(field::kControlStart)) {
    start();
  } else if (given(field::kControlLoadDone)) {
    load_done();
  } else if (given(field::kControlUpdateNode)) {
    update_node();
  }
}

// Returns false and raises bad_setting where the board cannot work with the registers.
bool Accelerator::settings_from_registers(fixed::Settings& s) {
  const auto bad = [this](Register reg) {
    raise({ErrorCode::bad_setting, offset_of(reg)});
    return false;
  };
  const std::uint32_t method = bank_.get(field::kMethodMethod);
  if (method > 1) return bad(Register::method);
  s.method = method == static_cast<std::uint32_t>(SolverMethod::cg) ? fixed::Method::cg
                                                                    : fixed::Method::jacobi_pcg;
  s.start = bank_.get(field::kStartModeMode) == static_cast<std::uint32_t>(StartMode::warm)
                ? fixed::Start::warm
                : fixed::Start::zero;
  s.iterations = static_cast<int>(bank_.get(field::kIterationsCount));
  if (s.iterations < 1) return bad(Register::iterations);
  s.static_shift = static_cast<int>(bank_.get(field::kStaticShiftShift));
  if (s.static_shift > 31) return bad(Register::static_shift);
  s.dynamic_scaling = bank_.get(field::kScalingDynamic) != 0;
  s.headroom_bits = static_cast<int>(bank_.get(field::kScalingHeadroomBits));
  if (s.headroom_bits > 8) return bad(Register::scaling);
  s.matrix_bits = static_cast<int>(bank_.get(field::kFormatMatrixBits));
  s.vector_bits = static_cast<int>(bank_.get(field::kFormatVectorBits));
  s.coefficient_bits = static_cast<int>(bank_.get(field::kFormatCoefficientBits));
  const bool words = s.matrix_bits >= 8 && s.matrix_bits <= 24 && s.vector_bits >= 12 &&
                     s.vector_bits <= 32 && s.coefficient_bits >= 8 && s.coefficient_bits <= 24;
  if (!words || bank_.get(field::kFormatRhsBits) != static_cast<std::uint32_t>(s.residual_bits())) {
    return bad(Register::format);
  }
  try {
    s.check();
  } catch (const InputError&) {
    return bad(Register::scaling);
  }
  return true;
}

void Accelerator::run_for(Running what, std::int64_t clocks) {
  running_ = what;
  clocks_ = clocks;
  started_ = now_ps();
  job_tag_ = *commanding_tag_;
  bank_.set(field::kStatusBusy, 1);
  done_.notify(to_sc_time(untimed_ ? 0 : clocks * architecture_.clock_period_ps()));
}

void Accelerator::start() {
  if (bank_.get(field::kStatusMatrixLoaded) == 0) {
    raise({ErrorCode::not_loaded, 0});
    return;
  }
  fixed::Settings settings;
  if (!settings_from_registers(settings)) return;
  if (solver_ == nullptr || settings != settings_) {
    settings_ = settings;
    solver_ = fixed::make_solver(settings_);
    solver_->load(matrix_);
    solve_clocks_ =
        accel::solve_cycles(architecture_, pattern_, accel::longest_solve(settings_)).total();
  }
  bank_.set(field::kJobJob, bank_.get(field::kJobJob) + 1);
  run_for(Running::solve, solve_clocks_);
}

void Accelerator::load_done() {
  fixed::Settings settings;
  if (!settings_from_registers(settings)) return;
  if (const BoardError error = read_matrix(bank_, matrix_); error.code != ErrorCode::none) {
    raise(error);
    return;
  }
  pattern_ = accel::pattern_of(matrix_.row_begin);
  solver_.reset();
  b_.assign(static_cast<std::size_t>(matrix_.rows()), 0);
  u_.assign(static_cast<std::size_t>(matrix_.rows()), 0);
  run_for(Running::load, accel::load_cycles(architecture_, pattern_, settings.method));
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
    std::vector<std::int32_t> original(present.size());
    const std::span<const std::uint32_t> staged = bank_.memory(Aperture::row);
    for (std::size_t i = 0; i < original.size(); ++i) {
      original[i] = packed_element(staged, i, static_cast<unsigned>(matrix_.bits));
    }
    matrix_.restore_row(row, original);
  }
  if (solver_ != nullptr) solver_->update(row);
  write_back_node(matrix_, row, bank_);

  const auto begin = static_cast<std::size_t>(matrix_.row_begin[node]);
  const auto end = static_cast<std::size_t>(matrix_.row_begin[node + 1]);
  const bool jacobi =
      bank_.get(field::kMethodMethod) == static_cast<std::uint32_t>(SolverMethod::jacobi_pcg);
  const std::int64_t clocks = accel::node_update_cycles(
      architecture_, pattern_, row, std::span(matrix_.column).subspan(begin, end - begin),
      jacobi ? fixed::Method::jacobi_pcg : fixed::Method::cg);
  wait_states_ = untimed_ ? 0 : clocks * architecture_.clock_period_ps();
  ledger_.extend(*commanding_tag_, Part::fpga, Phase::node_update, now_ps(),
                 now_ps() + wait_states_);
}

void Accelerator::reset() {
  done_.cancel();
  running_ = Running::nothing;
  solver_.reset();
  bank_.reset();
  drive_interrupt_line(*commanding_tag_);
}

void Accelerator::finish() {
  bank_.set(field::kStatusBusy, 0);
  const Running ended = std::exchange(running_, Running::nothing);
  if (ended == Running::load) {
    bank_.set(field::kStatusMatrixLoaded, 1);
  } else {
    // Before anything can go wrong: a frame that follows a fault follows this span too.
    ledger_.extend(job_tag_, Part::fpga, Phase::solve, started_, now_ps());
    try {
      solve();
    } catch (const InputError& e) {
      spdlog::warn("the board's solver stopped: {}", e.what());
      raise({ErrorCode::internal_fault, 0});
      return;
    }
  }
  bank_.set(field::kInterruptStatusDone, 1);
  mirror_status();
  drive_interrupt_line(job_tag_);
}

void Accelerator::solve() {
  const unsigned rhs_bits = bank_.get(field::kFormatRhsBits);
  const unsigned vector_bits = bank_.get(field::kFormatVectorBits);
  const std::span<const std::uint32_t> b_words = bank_.memory(Aperture::b);
  const std::span<std::uint32_t> u_words = bank_.memory(Aperture::u);
  for (std::size_t i = 0; i < b_.size(); ++i) {
    b_[i] = packed_element(b_words, i, rhs_bits);
    u_[i] = packed_element(u_words, i, vector_bits);
  }
  report_ = solver_->solve({b_, u_});
  saturations_ += report_.saturations;
  breakdowns_ += report_.breakdowns;
  if (job_tag_.frame >= 0) ledger_.frame(job_tag_.frame).saturations = report_.saturations;
  for (std::size_t i = 0; i < u_.size(); ++i) {
    set_packed_element(u_words, i, vector_bits, u_[i]);
  }
  bank_.set(field::kResultJobJob, bank_.get(field::kJobJob));
  bank_.set(field::kResultIterationsCount, static_cast<std::uint32_t>(report_.iterations));
  bank_.set(field::kResultSaturationsCount, saturated(report_.saturations));
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
  if (interrupt.size() == 0) return;
  if (up) {
    interrupt->interrupt(tag);
  } else {
    interrupt->lowered();
  }
}

}  // namespace hvp::vp
