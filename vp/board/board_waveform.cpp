#include "vp/board/board_waveform.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace hvp::vp {

namespace {
// The registers that change without an access to them.
constexpr std::array kShown = {Register::status, Register::interrupt_status,
                               Register::interrupt_enable, Register::error, Register::job};
}  // namespace

BoardWaveform::BoardWaveform(const std::string& path)
    : file_(sc_core::sc_create_vcd_trace_file(path.c_str())) {
  // Saying so would go to the terminal.
  sc_core::sc_report_handler::set_actions("tracing timescale unit set", sc_core::SC_DO_NOTHING);
  file_->set_time_unit(1, sc_core::SC_PS);
}

void BoardWaveform::watch(Accelerator& accelerator) {
  sc_core::sc_trace_file* file = file_.get();
  const std::string top = std::string(accelerator.name()) + ".";
  sc_trace(file, accelerator.line_up(), top + "interrupt");
  for (const Register reg : kShown) {
    std::string name = top + "registers.";
    name += kRegisters[static_cast<std::size_t>(reg)].name;
    sc_trace(file, accelerator.bank().stored(reg), name, 32);
  }
  sc_trace(file, toggle_, top + "access.toggle");
  sc_trace(file, write_, top + "access.is_write");
  sc_trace(file, refused_, top + "access.refused");
  sc_trace(file, offset_, top + "access.offset", 32);
  sc_trace(file, bytes_, top + "access.bytes", 32);
  sc_trace(file, word_, top + "access.first_word", 32);
  if (accelerator.dma() == nullptr) return;
  accelerator.dma()->observe(*this);
  sc_trace(file, moves_, top + "dma.under_way");
  sc_trace(file, move_toggle_, top + "dma.transfer_toggle");
  sc_trace(file, move_reads_, top + "dma.is_read");
  sc_trace(file, move_purpose_, top + "dma.purpose", 3);
  sc_trace(file, move_address_, top + "dma.address", 64);
  sc_trace(file, move_bytes_, top + "dma.bytes", 32);
}

void BoardWaveform::begins(const MasterAccess& access) {
  moves_ = true;
  move_toggle_ = !move_toggle_;
  move_reads_ = access.read;
  move_purpose_ = static_cast<std::uint32_t>(access.purpose);
  move_address_ = access.address;
  move_bytes_ = static_cast<std::uint32_t>(access.data.size());
}

void BoardWaveform::access(Picoseconds /*time*/, Command command, const RegisterBank& /*bank*/,
                           const AccessResult& outcome, std::uint64_t offset,
                           std::span<const std::uint8_t> data) {
  toggle_ = !toggle_;
  write_ = command == Command::write;
  refused_ = !outcome.ok();
  offset_ = static_cast<std::uint32_t>(offset);
  bytes_ = static_cast<std::uint32_t>(data.size());
  word_ = 0;
  std::memcpy(&word_, data.data(), std::min(data.size(), sizeof word_));
}

}  // namespace hvp::vp
