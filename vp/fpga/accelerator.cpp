#include "vp/fpga/accelerator.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <spdlog/spdlog.h>

#include "models/config/input_error.h"
#include "vp/fpga/board_registers.h"
#include "vp/fpga/register_bank.h"
#include "vp/fpga/rtl_timing.h"

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
      architecture_(architecture),
      clock_period_(level == Timing::untimed ? 0 : architecture.clock_period_ps()),
      level_(level),
      numbers_(numbers),
      ledger_(ledger),
      observer_(observer),
      done_("done") {
  if (numbers == Numbers::none && engine_has_words(level)) {
    throw InputError("numbers", std::string("the ") + vp::name(level) +
                                    " engine makes the words: expected \"fixed\"");
  }
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
  for (const Register reg :
       {Register::method, Register::format, Register::nodes, Register::blocks, Register::packing}) {
    bank_.on_write(reg, [this, reg](std::uint32_t /*written*/, std::uint32_t before) {
      if (bank_.get(reg) != before) forget_matrix();
    });
  }
  for (const Aperture aperture : {Aperture::row_begin, Aperture::column}) {
    bank_.on_memory_write(aperture, [this] { forget_matrix(); });
  }
  bank_.on_memory_write(Aperture::value, [this] { bank_.set(field::kStatusMatrixLoaded, 0); });
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

void Accelerator::inject(FaultPlan& plan, Transport wire, const link::Pcie* link) {
  faults_ = &plan;
  wire_ = std::move(wire);
  if (dma_ != nullptr) dma_->inject(plan, link);
}

void Accelerator::require_supported(Timing level, const fixed::Settings& settings) {
  if (has_engine(level)) engine::require_supported(settings);
  if (level == Timing::rtl) require_rtl(settings);
}

// A job is refused where its level does not have the method.
bool Accelerator::supported(const fixed::Settings& settings) {
  try {
    require_supported(level_, settings);
    return true;
  } catch (const InputError& e) {
    spdlog::warn("the board refused a setting: {}", e.what());
    raise(bad_setting(field::kMethodMethod));
    return false;
  }
}

Accelerator::Transport Accelerator::behind() {
  return [this](tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
    answer(transaction, delay);
  };
}

void Accelerator::b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
  if (wire_) {
    wire_(transaction, delay);
  } else {
    answer(transaction, delay);
  }
}

void Accelerator::answer(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
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
  if (command == Command::read && outcome.ok()) note_read(offset, data.size());
  if (observer_ != nullptr) observer_->access(now_ps(), command, bank_, outcome, offset, data);
  if (!outcome.ok()) {
    ++illegal_accesses_;
    spdlog::warn("{} at {}.{:03} ns", bank_.describe(outcome, command), now_ps() / 1000,
                 now_ps() % 1000);
    // Of a read, PCI Express accounts for the way with the answer: the interrupt comes out of the
    // way to here.
    Tag refused = *commanding_tag_;
    if (command == Command::read && refused.frame >= 0 && ledger_.has(refused.frame)) {
      const Picoseconds since = ledger_.end_of(refused);
      const Phase phase = data.size() > 4 ? Phase::block_read : Phase::bus_read;
      if (since < now_ps()) ledger_.extend(refused, Part::bus, phase, since, now_ps());
    }
    commanding_tag_ = &refused;
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
  } else if (given(field::kControlFetchValues)) {
    fetch_values();
  } else if (given(field::kControlUpdateValues)) {
    update_values();
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
    bank_.set(field::kErrorPlace, error.place);
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
    bank_.set(field::kErrorPlace, 0);
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

void Accelerator::forget_matrix() {
  bank_.set(field::kStatusMatrixLoaded, 0);
  bank_.set(field::kStatusPatternLoaded, 0);
}

void Accelerator::load_done() {
  forget_matrix();
  fixed::Settings settings;
  BoardError error = read_settings(bank_, settings);
  if (error.code == ErrorCode::none) error = read_matrix(bank_, matrix_);
  if (error.code != ErrorCode::none) {
    raise(error);
    return;
  }
  if (!supported(settings) || !load_memories(settings)) return;
  solver_.reset();
  loaded_settings_ = settings;
  has_previous_u_ = false;
  b_.assign(static_cast<std::size_t>(matrix_.rows()), 0);
  u_.assign(static_cast<std::size_t>(matrix_.rows()), 0);
  give_x();
  begin(Running::load, *commanding_tag_);
  end_after(timing_->start_load(settings));
}

bool Accelerator::may_renew(fixed::Settings& settings) {
  if (bank_.get(field::kStatusPatternLoaded) == 0) {
    raise({ErrorCode::not_loaded, 0});
    return false;
  }
  if (const BoardError error = read_settings(bank_, settings); error.code != ErrorCode::none) {
    raise(error);
    return false;
  }
  return supported(settings);
}

void Accelerator::update_values() {
  fixed::Settings settings;
  if (!may_renew(settings)) return;
  if (const BoardError error = read_values(bank_, matrix_); error.code != ErrorCode::none) {
    raise(error);
    return;
  }
  renew(settings, *commanding_tag_);
}

// Structure, contact and U stay. A solver takes the words in place, so that nothing is allocated in
// the servo loop; P⁻¹ takes what it takes at the end of a load.
void Accelerator::renew(const fixed::Settings& settings, const Tag& tag) {
  for (int node = 0; node < matrix_.block_rows(); ++node) {
    if (matrix_.is_contact[static_cast<std::size_t>(node)] != 0) {
      write_back_node(matrix_, node, bank_);
    }
  }
  timing_->renew(matrix_, settings);
  forget_flips();
  if (solver_ != nullptr) solver_->load(matrix_);
  has_previous_u_ = false;
  give_x();
  begin(Running::update, tag);
  end_after(timing_->start_load(settings));
}

// Through the driver's frames nothing may be thrown.
bool Accelerator::load_memories(const fixed::Settings& settings) {
  try {
    timing_->load(matrix_, settings);
    forget_flips();
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
  if (!change_row(row)) return;
  if (solver_ != nullptr) solver_->update(row);
  write_back_node(matrix_, row, bank_);
  // A matrix is loaded, so that METHOD is what it was loaded with.
  hold_access(timing_->update_node(matrix_, row, loaded_settings_, row_));
}

// The node's row and column, as the registers say; false for what the board refuses.
bool Accelerator::change_row(int node) {
  if (bank_.get(field::kUpdateKindKind) == static_cast<std::uint32_t>(UpdateKind::constrain)) {
    try {
      matrix_.set_contact(node, static_cast<std::int32_t>(bank_.get(field::kUpdateDiagonalValue)));
    } catch (const InputError&) {
      raise(bad_setting(field::kUpdateDiagonalValue));
      return false;
    }
    return true;
  }
  const std::span<const std::int32_t> present = matrix_.row(node);
  const std::size_t blocks = present.size() / 9;
  if (bank_.get(field::kUpdateBlocksCount) != blocks) {
    raise({ErrorCode::bad_row, static_cast<std::uint32_t>(blocks)});
    return false;
  }
  row_.resize(present.size());
  const std::span<const std::uint32_t> staged = bank_.memory(Aperture::row);
  for (std::size_t i = 0; i < row_.size(); ++i) {
    row_[i] = packed_element(staged, i, static_cast<unsigned>(matrix_.bits), one_a_word());
  }
  matrix_.restore_row(node, row_);
  return true;
}

// U is an engine's memory of x, which it brings into the copies of d when the host has written.
void Accelerator::give_x() {
  if (u_.empty()) return;  // no matrix has been loaded
  written_x_.resize(timing_->has_words() ? u_.size() : 0);
  const unsigned vector_bits = bank_.get(field::kFormatVectorBits);
  const std::span<const std::uint32_t> words = bank_.memory(Aperture::u);
  for (std::size_t i = 0; i < written_x_.size(); ++i) {
    written_x_[i] = packed_element(words, i, vector_bits, one_a_word());
  }
  timing_->write_x(written_x_);
}

void Accelerator::hold_access(std::int64_t clocks) {
  wait_states_ = clocks * clock_period_;
  ledger_.extend(*commanding_tag_, Part::fpga, Phase::node_update, now_ps(),
                 now_ps() + wait_states_);
}

}  // namespace hvp::vp
