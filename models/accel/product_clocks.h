#pragma once

#include <cstdint>
#include <vector>

#include "models/accel/architecture.h"
#include "models/accel/cycles.h"

namespace hvp::accel {

// The clocks for which a package of `columns` columns occupies the multipliers; its first column is
// component `phase` of its node. The bank of d that is read most decides, and, where fewer than
// three rows of a node go at once, their number. With several banks it is the mean over all ways in
// which the nodes can fall into them.
double package_clocks(const Architecture& a, int phase, int columns);

// The clocks for which the packages of each stored row occupy the multipliers. With several banks
// they are counted package by package if the pattern has its columns, and are means otherwise.
std::vector<double> clocks_of_rows(const Architecture& a, const Pattern& stored);

// The clocks in which the fullest partition issues its packages: their number if no bank is asked
// for more than it gives. Rows are dealt as packages_in_fullest_partition() says.
std::int64_t issue_clocks_of_fullest_partition(const Architecture& a, const Pattern& whole);

// The rows of one product on their way from the partitions to the vector unit, counted row by row.
// A partition issues its rows one after the other, in the order of their numbers; a row is in its
// queue memory_read + multiplier + adder_tree clocks after its last package. The vector unit takes
// L rows a clock at most, one of each partition in turn, and one into each of the L memories of
// A·d. The place of a row that was taken is free a clock later; a partition waits for a free place.
struct RowSchedule {
  std::int64_t issued = 0;  // clocks of the fullest partition if nothing makes it wait
  // The clocks until the last row is taken, without its way through the pipelines. A product begins
  // with the turn that the one before it has left: this is the mean of successive products once
  // they repeat, rounded.
  std::int64_t taken = 0;
};
// Rows are dealt as packages_in_fullest_partition() says. Throws InputError as packages_of() does.
RowSchedule row_schedule(const Architecture& a, const Pattern& p);

}  // namespace hvp::accel
