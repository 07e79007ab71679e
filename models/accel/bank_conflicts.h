#pragma once

#include <cstdint>
#include <vector>

#include "models/accel/architecture.h"
#include "models/accel/cycles.h"

namespace hvp::accel {

// Clocks that the multipliers hold a package of so many columns, the first of them component
// `phase` of its node: those of the bank of d that is asked most, and those of the three rows of a
// node where fewer go at once. With several banks the mean over all ways in which the nodes can
// fall into them.
double package_clocks(const Architecture& a, int phase, int columns);

// Clocks that the multipliers hold the packages of each row that is stored. Packages of several
// banks are counted as they are where the pattern has its columns.
std::vector<double> clocks_of_rows(const Architecture& a, const Pattern& stored);

// Clocks in which the fullest partition issues its packages; their number where no bank is asked
// for more than it gives. Rows are dealt as packages_in_fullest_partition() says.
std::int64_t issue_clocks_of_fullest_partition(const Architecture& a, const Pattern& whole);

}  // namespace hvp::accel
