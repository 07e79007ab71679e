#include "models/accel/packing.h"

#include "models/accel/symmetric.h"

namespace hvp::accel {

Packing packing(const Architecture& a, const Pattern& whole) {
  Pattern scratch;
  const Pattern& p = stored_pattern(a, whole, scratch);
  Packing packing;
  for (const int blocks : p.blocks_in_row) {
    packing.nonzeros += std::int64_t{9} * blocks;
    packing.stored += std::int64_t{3} * packages_of(a, blocks) * a.package;
  }
  packing.balance = balance_of(a, p, deal_rows(a, p, a.partitions), a.partitions);
  return packing;
}

}  // namespace hvp::accel
