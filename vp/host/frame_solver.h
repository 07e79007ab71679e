#pragma once

#include <cstdint>
#include <span>

#include "driver/hvp_driver.h"
#include "models/time/picoseconds.h"
#include "vp/frame/servo_counts.h"

namespace hvp::vp {

// An observer of the driver's calls that the servo process makes, and of the U that it gets: all
// that another host needs to repeat the same jobs. All reported calls have succeeded, except the
// start of a job.
class JobObserver {
 public:
  virtual ~JobObserver() = default;
  virtual void configured(const hvp_solver_config& config) = 0;
  virtual void loaded(const hvp_matrix& matrix) = 0;
  // U from which the next job starts.
  virtual void guessed(std::span<const std::int32_t> u) = 0;
  virtual void constrained(std::uint32_t node, std::int32_t diagonal) = 0;
  // `values` are nine for each block, with the row's blocks in the matrix' order.
  virtual void restored(std::uint32_t node, std::span<const std::int32_t> values) = 0;
  // All values of the matrix, in its order.
  virtual void renewed(std::span<const std::int32_t> values) = 0;
  virtual void started(std::span<const std::int32_t> b) = 0;
  // `flags` is hvp_last_flags().
  virtual void solved(std::span<const std::int32_t> u, std::uint32_t flags) = 0;
};

// A solver of a frame's displacements: the board behind its driver, or the host itself. All calls
// are made in the servo thread and take simulated time.
class FrameSolver {
 public:
  virtual ~FrameSolver() = default;

  // Makes the next piece of the set-up, after which the solver has the matrix without contact;
  // before the first frame, and again after a frame that failed. Sets `done` with the last piece.
  // After an error the next piece is the first one again.
  virtual hvp_status set_up_piece(bool& done) = 0;
  // Returns true if the solver can go on after a frame that failed with this status, false if it
  // has to be set up again.
  virtual bool survives(hvp_status /*status*/) const { return true; }
  // The time at which the frame's force is due. Failed accesses are not repeated after it.
  virtual void set_deadline(Picoseconds /*time*/) {}
  // The nodes (active, ascending) that are contact nodes from now on.
  virtual hvp_status move_contact(std::span<const int> nodes) = 0;
  // Works until the solver has its job and the host need not wait for it.
  virtual hvp_status begin(std::uint32_t& flags) = 0;
  // The same after the force is out, from the solution so far, where contact is a load that was not
  // known before and moves no node by much more than `way`, m.
  virtual hvp_status go_on(double way, std::uint32_t& flags) = 0;
  // Waits for the solve that begin() or go_on() started and takes the solution.
  virtual hvp_status end(std::uint32_t& flags) = 0;
  // Makes the work that remains after the force is out.
  virtual void finish(std::uint32_t& flags) = 0;
  // Gives the solver the system's values where they have changed since it took them last. Between
  // solves; after an error it has to be set up again.
  virtual hvp_status renew() { return HVP_OK; }
  virtual hvp_status close() = 0;

  // Reports the board's jobs; a solver without a board has none.
  virtual void observe(JobObserver& /*observer*/) {}

  // The errors since the last call that were put right.
  virtual Mended take_mended() { return {}; }

  // The number of clamped words in right-hand sides since the last call.
  virtual std::int64_t take_clamped_words() { return 0; }
};

}  // namespace hvp::vp
