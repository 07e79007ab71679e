#include "models/accel/operations.h"

#include <numeric>

namespace hvp::accel {

namespace {

using fixed::Method;

// The operations on vectors alone, for each component: two for an inner product or an update by a
// coefficient, one for an entry of the inverse diagonal, five for a row of an inverse block.
std::int64_t vector_operations_a_component(Method method) {
  constexpr std::int64_t kCg = 5 * 2;  // dᵀA·d, x, r, rᵀr, d
  switch (method) {
    case Method::cg:
      return kCg;
    case Method::jacobi_pcg:
      return kCg + 1;
    case Method::block_jacobi_pcg:
      return kCg + 5;
    case Method::chronopoulos_gear:
      return kCg + 2;  // A·d by a recurrence
    case Method::pipelined_cg:
      return kCg + 6;  // A·d, A·r and A·A·d by recurrences
  }
  return kCg;
}

double rate(std::int64_t operations, std::int64_t clocks, double clock_hz) {
  if (clocks == 0) return 0;
  return static_cast<double>(operations) / static_cast<double>(clocks) * clock_hz;
}

}  // namespace

std::int64_t product_operations(const Pattern& p) {
  const std::int64_t blocks =
      std::accumulate(p.blocks_in_row.begin(), p.blocks_in_row.end(), std::int64_t{0});
  return 2 * 9 * blocks - 3 * std::int64_t{p.nodes()};
}

std::int64_t iteration_operations(const Pattern& p, Method method) {
  return product_operations(p) +
         3 * std::int64_t{p.nodes()} * vector_operations_a_component(method);
}

OperationRate operation_rate(const Architecture& a, const Pattern& p, Method method,
                             const SolveCycles& cycles) {
  OperationRate r;
  const double partitions_a_second =
      static_cast<double>(a.several ? a.several->devices : 1) * a.partitions * a.clock_hz;
  r.thesis = kThesisOperationsAPartition * partitions_a_second;
  r.peak = 2.0 * a.rows_in_parallel * a.package * partitions_a_second;
  r.product = rate(product_operations(p), cycles.sparse_product, a.clock_hz);
  r.solve = rate(cycles.iterations * iteration_operations(p, method), cycles.total(), a.clock_hz);
  return r;
}

}  // namespace hvp::accel
