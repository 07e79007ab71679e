#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "app/results/part_files.h"
#include "vp/board/board_side.h"
#include "vp/board/board_waveform.h"
#include "vp/fpga/accelerator.h"
#include "vp/frame/frame_tag.h"
#include "vp/host/frame_solver.h"

// Records of what software and the board exchange: --trace-registers and --record-jobs.

namespace hvp::results {

// registers.log: every access to the solver board's BAR, a line each, with the simulated time
// since power-up, the register's name, the first word and, of a refused access, the reason.
class RegisterLog : public vp::AccessObserver {
 public:
  explicit RegisterLog(const std::filesystem::path& path);
  void access(vp::Picoseconds time, vp::Command command, const vp::RegisterBank& bank,
              const vp::AccessResult& outcome, std::uint64_t offset,
              std::span<const std::uint8_t> data) override;
  void finish() { stream_.finish(); }

 private:
  PartStream stream_;
};

// dma.log: every transaction of the board's own, a line each, with the simulated times since
// power-up at its begin and end, the job, what it moved and where to, and the data's CRC-32.
class DmaLog : public vp::MasterObserver {
 public:
  explicit DmaLog(const std::filesystem::path& path);
  void transferred(const vp::MasterAccess& access) override;
  void finish() { stream_.finish(); }

 private:
  PartStream stream_;
};

// What --trace-dma asks for: `lanes` sees the engine's transactions too, and so does a dma.log in
// the folder; an empty one: another trace writes it. Without an engine it is a warning.
void trace_dma(vp::DmaEngine* engine, vp::MasterObserver& lanes,
               const std::filesystem::path& folder, std::optional<DmaLog>& log);

enum class WaveformFormat { vcd, fst };

// <name>.vcd or <name>.fst. A tracer opens, writes and closes it under another name; finish()
// renames it, and the destructor removes a file that was not finished.
class WaveformFile {
 public:
  WaveformFile(const std::filesystem::path& folder, std::string_view name,
               WaveformFormat format = WaveformFormat::vcd);
  ~WaveformFile();
  WaveformFile(const WaveformFile&) = delete;
  WaveformFile& operator=(const WaveformFile&) = delete;

  // The tracer's file name, to which the tracer adds ".vcd" or ".fst".
  std::string tracer_file() const;
  // Call it after the tracer has closed its file. Blanks the date in the header, so that the same
  // scenario gives the same bytes, and gives the file its name. Throws std::runtime_error where the
  // file is not whole.
  void finish();

 private:
  WaveformFormat format_;
  UnfinishedFile part_;
  std::filesystem::path path_;
  bool finished_ = false;
};

// The files that --trace-registers writes into a folder: registers.log; where there is a board,
// registers.vcd; and where that board is a bus master, dma.log.
class RegisterTrace : public vp::AccessObserver {
 public:
  explicit RegisterTrace(const std::filesystem::path& folder)
      : folder_(folder), log_(folder / "registers.log") {}

  // Adds registers.vcd and dma.log. Call it once, before simulation starts.
  void watch(vp::Accelerator& accelerator) {
    if (accelerator.dma() != nullptr) {
      dma_log_.emplace(folder_ / "dma.log");
      accelerator.dma()->observe(*dma_log_);
    }
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
    if (dma_log_) dma_log_->finish();
    if (!waveform_) return;
    // A waveform begins with the first step of time, which a board that nobody accessed never made.
    if (vp::now_ps() == 0) vp::BoardSide::step_to(1);
    waveform_->close();
    file_->finish();
  }

 private:
  std::filesystem::path folder_;
  RegisterLog log_;
  std::optional<DmaLog> dma_log_;
  std::optional<WaveformFile> file_;
  std::optional<vp::BoardWaveform> waveform_;  // closed before its file is removed
};

// The files that --record-jobs writes into a folder, with which another host, such as hvp-servo in
// a guest, has the same jobs solved: jobs.hvpf has settings, matrix and each job's changes and b,
// jobs.hvpu each job's U. driver/linux/guest/servo_frames.h defines both formats. Each job has a
// frame of its own there, also where a frame of the run has several or none, and the times of
// jobs.hvpu are zero.
//
// The format has no place for a U to start from other than zero, or for settings that are sent
// again: the record ends before that and keeps the reason.
class JobRecord : public vp::JobObserver {
 public:
  // Throws std::runtime_error where a file cannot be created.
  JobRecord(const std::filesystem::path& folder, vp::Picoseconds period);

  void configured(const hvp_solver_config& config) override;
  void loaded(const hvp_matrix& matrix) override;
  void guessed(std::span<const std::int32_t> u) override;
  void constrained(std::uint32_t node, std::int32_t diagonal) override;
  void restored(std::uint32_t node, std::span<const std::int32_t> values) override;
  void renewed(std::span<const std::int32_t> values) override;
  void started(std::span<const std::int32_t> b) override;
  void solved(std::span<const std::int32_t> u, std::uint32_t flags) override;
  // Throws std::runtime_error where a file is not whole.
  void finish();

  std::uint32_t jobs() const { return jobs_; }
  // The reason why the record ended before the last job; empty where it has all jobs.
  const std::optional<std::string>& ended_early() const { return ended_; }

 private:
  void end(std::string_view why);

  PartStream frames_;
  PartStream solutions_;
  std::uint64_t period_ns_;
  std::string config_;   // in the file's form
  std::string changes_;  // of the matrix since the last job, in the file's form
  std::uint32_t change_count_ = 0;
  std::string job_;  // the job that is being solved; empty: none
  std::string solution_;
  bool loaded_ = false;
  std::uint32_t jobs_ = 0;
  std::optional<std::string> ended_;
};

}  // namespace hvp::results
