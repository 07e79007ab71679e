#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "app/results/part_stream.h"
#include "vp/frame/frame_tag.h"
#include "vp/host/job_observer.h"

namespace hvp::results {

// What --record-jobs writes into a folder, so that another host has the same jobs solved, hvp-servo
// in a guest for instance: jobs.hvpf, settings, matrix and the changes and b of each job, and
// jobs.hvpu, the U of each. Their forms are those of driver/linux/guest/servo_frames.h; a job has a
// frame of its own there, also where a frame of the run has several or none, and the times of
// jobs.hvpu are zero.
//
// The file has no place for a U to start from other than zero, or for settings that are sent again:
// the record ends before that, and says why.
class JobRecord : public vp::JobObserver {
 public:
  // Throws std::runtime_error where a file cannot be created.
  JobRecord(const std::filesystem::path& folder, vp::Picoseconds period);

  void configured(const hvp_solver_config& config) override;
  void loaded(const hvp_matrix& matrix) override;
  void guessed(std::span<const std::int32_t> u) override;
  void constrained(std::uint32_t node, std::int32_t diagonal) override;
  void restored(std::uint32_t node, std::span<const std::int32_t> values) override;
  void started(std::span<const std::int32_t> b) override;
  void solved(std::span<const std::int32_t> u, std::uint32_t flags) override;

  // Throws std::runtime_error where a file is not whole.
  void finish();
  std::uint32_t jobs() const { return jobs_; }
  // Why not all jobs are there; nothing where they are.
  const std::optional<std::string>& ended_early() const { return ended_; }

 private:
  void end(std::string_view why);

  PartStream frames_;
  PartStream solutions_;
  std::uint64_t period_ns_;
  std::string config_;   // as the file has it
  std::string changes_;  // of the matrix since the last job, likewise
  std::uint32_t change_count_ = 0;
  std::string job_;  // the one that is under way; empty: none
  std::string solution_;
  bool loaded_ = false;
  std::uint32_t jobs_ = 0;
  std::optional<std::string> ended_;
};

}  // namespace hvp::results
