#include "vp/fpga/accelerator.h"

#include <cmath>
#include <utility>

#include <spdlog/spdlog.h>

#include "models/config/input_error.h"
#include "vp/fpga/board_settings.h"

namespace hvp::vp {

namespace {

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

}  // namespace

Accelerator::Accelerator(const sc_core::sc_module_name& name,
                         const accel::Architecture& architecture, Timing level, Ledger& ledger,
                         AccessObserver* observer, Numbers numbers, const MasterSettings& master)
    : sc_module(name),
      from_bus("from_bus"),
      interrupt("interrupt"),
      clock_period_(level == Timing::untimed ? 0 : architecture.clock_period_ps()),
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
    give_x();
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
  timing_ = make_job_timing(level, architecture);
  if (const sc_core::sc_event* ended = timing_->ended()) sensitive << *ended;
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
  const AccessResult outcome =
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

void Accelerator::reset() {
  done_.cancel();
  timing_->abort();
  running_ = Running::nothing;
  listed_ = false;
  if (dma_ != nullptr) dma_->abort();
  solver_.reset();
  has_previous_u_ = false;
  bank_.reset();
  drive_interrupt_line(*commanding_tag_);
}

void Accelerator::power_on() {
  Tag none;
  Tag* const commanding = std::exchange(commanding_tag_, &none);
  reset();
  commanding_tag_ = commanding;
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
  const bool message =
      dma_ != nullptr && dma_->sends_messages() && (!messages_enabled_ || messages_enabled_());
  if (up && message) {
    dma_->send_message(tag);
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
