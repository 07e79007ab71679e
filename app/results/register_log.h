#pragma once

#include <filesystem>

#include "app/results/part_stream.h"
#include "vp/fpga/accelerator.h"

namespace hvp::results {

// registers.log: every access to the solver board's BAR, a line each, with the simulated time
// since power-up, what was accessed by name, the first word, and why it was refused if it was.
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

}  // namespace hvp::results
