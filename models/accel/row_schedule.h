#pragma once

#include <cstdint>

#include "models/accel/architecture.h"
#include "models/accel/cycles.h"

namespace hvp::accel {

// The rows of one product on their way from the partitions to the vector unit, counted row by row.
// A partition issues its rows one after the other, in the order of their numbers; a row is in its
// queue memory_read + multiplier + adder_tree clocks after its last package. The vector unit takes
// L rows a clock at most, in turn one of each partition, and one into each of the L memories of
// A·d. The place of a row that was taken is free a clock later; without one a partition waits.
struct RowSchedule {
  std::int64_t issued = 0;  // clocks of the fullest partition where nothing makes it wait
  // Clocks until the last row is taken, without its way through the pipelines. Whose turn it is at
  // the beginning of a product is left from the one before it: the mean of the products that
  // follow each other once they repeat, rounded.
  std::int64_t taken = 0;
};
// Rows are dealt as packages_in_fullest_partition() says. Throws InputError as packages_of() does.
RowSchedule row_schedule(const Architecture& a, const Pattern& p);

}  // namespace hvp::accel
