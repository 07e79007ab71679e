#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "models/fixed/settings.h"
#include "models/host/frame_computation.h"
#include "vp/host/dma_memory.h"
#include "vp/host/driver_port.h"
#include "vp/host/frame_solver.h"

namespace hvp::vp {

// The entries of the board's matrix where it is renewed during a run; else 0.
std::size_t renewed_entries(const host::FrameComputation& computation);

// A solver of frames on the board: sends b in words and receives U, in several passes with
// refinement. It reaches the board through the driver alone.
class BoardSolver : public FrameSolver {
 public:
  // Keeps references. `settings` are the board's; `port` is the driver's connection to it.
  // `reject_saturated`: a saturated solve counts as failed. `memory` is the memory from which a DMA
  // engine reads b and a renewed matrix and to which it writes U; null without one. Throws
  // InputError with the key "transfer.dma.segment_bytes" if the engine has too few descriptors.
  BoardSolver(const fixed::Settings& settings, host::FrameComputation& computation,
              const DriverPort& port, const Work& work, bool reject_saturated = false,
              HostMemory* memory = nullptr);

  hvp_status set_up_piece(bool& done) override;
  bool survives(hvp_status status) const override { return status == HVP_ERROR_SATURATED; }
  void set_deadline(Picoseconds time) override { deadline_ = time; }
  hvp_status move_contact(std::span<const int> nodes) override;
  hvp_status begin(std::uint32_t& flags) override;
  hvp_status go_on(double way, std::uint32_t& flags) override;
  hvp_status end(std::uint32_t& flags) override;
  void finish(std::uint32_t& flags) override;
  hvp_status renew() override;
  void observe(JobObserver& observer) override { observer_ = &observer; }
  hvp_status close() override { return hvp_close(&device_); }
  Mended take_mended() override { return std::exchange(mended_, {}); }
  std::int64_t take_clamped_words() override { return std::exchange(clamped_words_, 0); }

 private:
  enum class Piece { open, configure, begin_load, load, end_load, guess };

  hvp_status open();
  hvp_status configure();
  hvp_status make(Piece piece, bool& complete);
  hvp_status restore_node(int node, std::span<const int> nodes);
  bool next();
  hvp_status start_first(std::uint32_t& flags);
  hvp_status start();
  hvp_status receive();
  hvp_status wait();
  hvp_status read();
  void note_unacknowledged(int lost);
  bool try_again(hvp_status status, int& tries, Picoseconds took);
  hvp_status write_guess();

  fixed::Settings settings_;
  host::FrameComputation& computation_;
  const DriverPort& port_;
  const Work& work_;
  bool reject_saturated_;
  Phase phase_;  // the phase of the host's work around the solves

  JobObserver* observer_ = nullptr;
  std::optional<DmaMemory> dma_;
  hvp_device device_{};
  hvp_load load_{};
  hvp_matrix matrix_{};
  std::int64_t revision_ = 0;  // of the matrix on the board
  Piece next_ = Piece::open;
  bool guess_is_stale_ = false;
  Picoseconds deadline_ = 0;
  hvp_statistics seen_{};
  std::int64_t acknowledged_frame_ = -1;  // the frame whose job was waited for last
  Mended mended_;
  std::vector<std::uint32_t> scratch_;
  std::vector<std::int32_t> b_;
  std::vector<std::int32_t> u_;
  std::vector<std::int32_t> row_;
  bool waits_for_board_ = false;
  std::int64_t clamped_words_ = 0;
};

}  // namespace hvp::vp
