#include "models/accel/structures.h"

#include <algorithm>

#include "models/accel/bits.h"
#include "models/accel/symmetric.h"

namespace hvp::accel {

namespace {

using fixed::Method;

class Engine {
 public:
  Engine(const Architecture& a, const WordLengths& w, const SystemSize& s) : a_(a), w_(w), s_(s) {}

  std::vector<Structure> take() {
    matrix();
    vectors();
    preconditioner();
    index();
    if (a_.matrix_storage == MatrixStorage::symmetric) {
      partial_sums();
    } else {
      results();
    }
    return std::move(all_);
  }

 private:
  // The editor reads a package while it writes another one back.
  void matrix() {
    all_.push_back({"matrix", Role::matrix, std::int64_t{a_.partitions} * a_.rows_in_parallel,
                    s_.packages * ceil_div(3, a_.rows_in_parallel),
                    std::int64_t{a_.package} * w_.matrix_bits, Access::read_write});
  }

  // The nodes of a package's columns, which component the first one is of, and the row they belong
  // to: it is where the result goes.
  void index() {
    constexpr int kComponentBits = 2;
    const int node = bits_to_number(s_.direction_nodes);
    const int nodes = nodes_in_package(a_.package) * node;
    const int end_of_row = a_.packages_per_row == 0 ? 1 : 0;
    all_.push_back({"index", Role::index, 1, s_.packages,
                    std::int64_t{a_.partitions} * (nodes + kComponentBits + node + end_of_row),
                    Access::stream});
  }

  // L memories a component, a node's in memory node mod L.
  void vector(const char* use, int bits, int components = 3, Role role = Role::vectors) {
    all_.push_back({use, role, std::int64_t{components} * a_.nodes_per_clock,
                    ceil_div(s_.nodes, a_.nodes_per_clock), bits, Access::read_write});
  }

  // The vector that is multiplied in every iteration is there once for each partition (§5.6), or
  // twice.
  void copies(const char* use) {
    const bool two = a_.direction_memory == DirectionMemory::two_copies;
    const int accesses = a_.direction_memory == DirectionMemory::double_pumped ? 4 : 2;
    all_.push_back({use, Role::copies,
                    std::int64_t{a_.partitions} * (two ? 2 : 1) * 3 * a_.direction_banks,
                    ceil_div(s_.direction_nodes, a_.direction_banks), w_.vector_bits,
                    Access::anywhere, accesses});
  }

  void vectors() {
    const int word = w_.vector_bits;
    const int residual = w_.preconditioned() ? kProductBits : word;
    const bool gear = w_.method == Method::chronopoulos_gear;
    const bool pipelined = w_.method == Method::pipelined_cg;
    if (gear || pipelined) {
      vector("d", word);
    } else {
      copies("d");
    }
    vector("x", word);
    if (w_.extrapolated) vector("previous x", word);
    vector("b", residual);
    if (gear) {
      copies("r");
    } else {
      vector("r", residual);
    }
    vector("A*d", pipelined ? word : kProductBits);
    if (gear) vector("A*r", kProductBits);
    if (pipelined) {
      copies("A*r");
      vector("A*A*r", kProductBits);
      vector("A*A*d", kProductBits);
    }
  }

  void preconditioner() {
    if (!w_.preconditioned()) return;
    vector("z", kProductBits, 3, Role::preconditioner);
    if (w_.method == Method::jacobi_pcg) {
      vector("inverse diagonal", kProductBits, 3, Role::preconditioner);
    } else {
      // Six words a node: the blocks are symmetric.
      vector("inverse blocks", kProductBits, 6, Role::preconditioner);
    }
  }

  // Exact partial sums of every partition for all nodes, dealt to banks as d is.
  void partial_sums() {
    all_.push_back({"partial sums of A*d", Role::copies,
                    std::int64_t{a_.partitions} * 3 * a_.direction_banks,
                    ceil_div(s_.direction_nodes, a_.direction_banks),
                    row_sum_bits(w_, s_.longest_row), Access::anywhere, sum_accesses(a_)});
  }

  void results() {
    const std::int64_t row = 3 * (row_sum_bits(w_, s_.longest_row) + w_.vector_bits);
    all_.push_back({"results", Role::queue, a_.partitions, a_.result_queue,
                    row + bits_to_number(s_.direction_nodes), Access::read_write});
  }

  const Architecture& a_;
  const WordLengths& w_;
  const SystemSize& s_;
  std::vector<Structure> all_;
};

}  // namespace

WordLengths word_lengths(const fixed::Settings& s) {
  WordLengths w;
  w.matrix_bits = s.matrix_bits;
  w.vector_bits = s.vector_bits;
  w.coefficient_bits = s.coefficient_bits;
  w.scalar_bits = s.scalar_bits;
  w.method = s.method;
  w.dynamic_scaling = s.dynamic_scaling;
  w.extrapolated = s.start == fixed::Start::extrapolated;
  w.stop_test = s.stop_residual > 0;
  return w;
}

SystemSize system_size(const Architecture& a, const Pattern& p) {
  SystemSize size;
  size.nodes = p.nodes_in_vectors();
  size.direction_nodes = p.nodes_in_direction();
  size.packages = packages_in_fullest_partition(a, p);
  if (p.nodes() > 0) size.longest_row = std::ranges::max(p.blocks_in_row);
  return size;
}

int row_sum_bits(const WordLengths& w, int longest_row) {
  return w.matrix_bits + w.vector_bits + bits_to_number(3 * std::int64_t{longest_row});
}

std::vector<Structure> structures(const Architecture& a, const WordLengths& w,
                                  const SystemSize& s) {
  return Engine(a, w, s).take();
}

}  // namespace hvp::accel
