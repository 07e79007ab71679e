#pragma once

#include <cstdint>
#include <span>

#include "driver/hvp_driver.h"

namespace hvp::vp {

// What the servo process asks of the board, as it calls the driver, and the U that it gets: all
// that another host needs to have the same jobs solved. Every call is one that has succeeded, but
// that of a job's beginning.
class JobObserver {
 public:
  virtual ~JobObserver() = default;
  virtual void configured(const hvp_solver_config& config) = 0;
  virtual void loaded(const hvp_matrix& matrix) = 0;
  // The U from which the next job starts.
  virtual void guessed(std::span<const std::int32_t> u) = 0;
  virtual void constrained(std::uint32_t node, std::int32_t diagonal) = 0;
  // `values`: nine a block, the row's blocks in the matrix' order.
  virtual void restored(std::uint32_t node, std::span<const std::int32_t> values) = 0;
  virtual void started(std::span<const std::int32_t> b) = 0;
  // `flags`: hvp_last_flags().
  virtual void solved(std::span<const std::int32_t> u, std::uint32_t flags) = 0;
};

}  // namespace hvp::vp
