#pragma once

#include <cstdint>

#include "models/accel/architecture.h"
#include "models/accel/cycles.h"

// Symmetric storage: of each pair of blocks (i, j) and (j, i) one is stored, in the row of the
// smaller index. A package is multiplied twice: by d of its columns for its own row, then, block by
// block transposed, by d of its row for its columns, in the same multipliers. The second product
// goes into sums that every partition keeps for all nodes, since any partition can meet any column;
// a pass at the end adds those of the partitions. A sum that is still on its way is taken from the
// adder (forwarded), which is assumed.
namespace hvp::accel {

// The blocks at and right of the diagonal. If the columns are not known, every row keeps half of
// its neighbours, rounded up.
Pattern upper_triangle(const Pattern& p);

// The stored blocks: all of `p`, or its upper triangle, which is put into `scratch`.
const Pattern& stored_pattern(const Architecture& a, const Pattern& p, Pattern& scratch);

// The accesses a clock that a bank of the partial sums has: two ports, at twice the clock if the
// copies of d run at it. Two copies help reading only.
int sum_accesses(const Architecture& a);

// The clocks of a package whose words of d take `direct` clocks and of whose columns at most `most`
// lie in one bank: both products, and a read and a write of each sum.
int symmetric_package_clocks(const Architecture& a, int direct, int most);

// The clocks of the pass that adds the partitions' sums, L nodes at a time, and clears them.
std::int64_t gathering_clocks(const Architecture& a, int nodes);

}  // namespace hvp::accel
