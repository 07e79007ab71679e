#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "app/results/register_log.h"
#include "app/results/waveform.h"
#include "vp/board/board_waveform.h"

namespace hvp::results {

// What --trace-registers writes into a folder: registers.log, and registers.vcd beside it where
// there is a board.
class RegisterTrace : public vp::AccessObserver {
 public:
  explicit RegisterTrace(const std::filesystem::path& folder)
      : folder_(folder), log_(folder / "registers.log") {}

  // Once, before simulation starts.
  void watch(const vp::Accelerator& accelerator) {
    file_.emplace(folder_, "registers");
    waveform_.emplace(file_->tracer_file());
    waveform_->watch(accelerator);
  }

  void access(vp::Picoseconds time, vp::Command command, const vp::RegisterBank& bank,
              const vp::AccessResult& outcome, std::uint64_t offset,
              std::span<const std::uint8_t> data) override {
    log_.access(time, command, bank, outcome, offset, data);
    if (waveform_) waveform_->access(time, command, bank, outcome, offset, data);
  }

  // Throws std::runtime_error where a file is not whole.
  void finish() {
    log_.finish();
    if (!waveform_) return;
    waveform_->close();
    file_->finish();
  }

 private:
  std::filesystem::path folder_;
  RegisterLog log_;
  std::optional<WaveformFile> file_;
  std::optional<vp::BoardWaveform> waveform_;  // closed before its file is removed
};

}  // namespace hvp::results
