#include "models/accel/memory.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "models/config/input_error.h"

namespace hvp::accel {

namespace {

int ceil_div(std::int64_t a, std::int64_t b) { return static_cast<int>((a + b - 1) / b); }

constexpr int kM4kBits = 4096;
constexpr int kM4kWords = 256;  // in the configuration 256 × 16 that vectors use
constexpr int kM512Words = 32;  // 32 × 16
constexpr int kMRamPortBits = 144;
constexpr int kUnitWords = 1024;  // the basic unit of Fig. 5.8: 1 K words from both ports
// §6.1: multipliers of the vector unit beside those of SpMxV, for 16-bit vectors and two nodes a
// clock.
constexpr int kVectorMultipliers = 21;
constexpr int kProductBits = fixed::Settings::kProductBits;

// Blocks for a vector with three components a node, each component in a memory of its own.
int vector_blocks(int nodes, int bits, int words_a_block) {
  return 3 * ceil_div(nodes, words_a_block) * ceil_div(bits, 16);
}

// Nodes, of three columns each, that a package touches at most. A row's first package starts with
// a node's first column; so do all others where whole nodes fill a package.
int nodes_in_package(int package) { return package % 3 == 0 ? package / 3 : (package + 1) / 3 + 1; }

using fixed::Method;

using Allocate = std::function<void(const char* use, const char* type, int blocks)>;

// What a device holds: nodes of its vectors and of the vector that is multiplied, which is longer
// where several devices share the rows.
struct Size {
  int nodes;
  int direction_nodes;
  std::int64_t packages;  // of the fullest partition
};

// The vector that is multiplied in every iteration is there once for each partition (§5.6), or
// twice.
void allocate_vectors(const Architecture& a, const WordLengths& w, const Size& size,
                      const Allocate& add) {
  const int nodes = size.nodes;
  const int copies = a.partitions * (a.direction_memory == DirectionMemory::two_copies ? 2 : 1);
  const auto vector = [nodes](int bits) { return vector_blocks(nodes, bits, kM4kWords); };
  const int word = vector(w.vector_bits);
  // The copies are dealt to banks; a bank has whole blocks.
  const int copy =
      a.direction_banks *
      vector_blocks(ceil_div(size.direction_nodes, a.direction_banks), w.vector_bits, kM4kWords);
  const int residual = vector(w.preconditioned() ? kProductBits : w.vector_bits);
  const int product = vector(kProductBits);
  const bool gear = w.method == Method::chronopoulos_gear;
  const bool pipelined = w.method == Method::pipelined_cg;
  add("d", "M4K", gear || pipelined ? word : copies * copy);
  add("x", "M4K", word);
  if (w.extrapolated) add("previous x", "M4K", word);
  add("b", "M4K", residual);
  add("r", "M4K", gear ? copies * copy : residual);
  add("A*d", "M4K", pipelined ? word : product);
  if (gear) add("A*r", "M4K", product);
  if (pipelined) {
    add("A*r", "M4K", copies * copy);
    add("A*A*r", "M4K", product);
    add("A*A*d", "M4K", product);
  }
}

void allocate_preconditioner(const Architecture& a, const WordLengths& w, int nodes,
                             const Allocate& add) {
  if (!w.preconditioned()) return;
  const bool m512 = a.preconditioner_memory == PreconditionerMemory::m512;
  const char* type = m512 ? "M512" : "M4K";
  const int vector = vector_blocks(nodes, kProductBits, m512 ? kM512Words : kM4kWords);
  add("z", type, vector);
  if (w.method == Method::jacobi_pcg) {
    add("inverse diagonal", type, vector);
  } else {
    add("inverse blocks", type, 2 * vector);  // six words a node: they are symmetric
  }
}

// Multipliers of 18 × 18 that a product of such words takes.
int products(int bits, int other_bits) { return ceil_div(bits, 18) * ceil_div(other_bits, 18); }

// What a component of a node takes beyond plain CG. Group c uses the multipliers of group b, unless
// they are one pass: without dynamic scaling, where no size of a vector has to be awaited.
int further_products(const WordLengths& w) {
  const int by_vector = products(w.coefficient_bits, w.vector_bits);
  const int by_product = products(w.coefficient_bits, kProductBits);
  const int words = products(w.vector_bits, w.vector_bits);
  const int wide = products(kProductBits, kProductBits);
  switch (w.method) {
    case Method::cg:
      return 0;
    case Method::jacobi_pcg:  // z = P⁻¹·r keeps pace with r; ‖r‖ is not zᵀr
      return wide + (w.stop_test ? wide : 0);
    case Method::block_jacobi_pcg:
      return 3 * wide + (w.stop_test ? wide : 0);
    case Method::chronopoulos_gear:  // with c in b's pass: β·d and β·q
      return w.dynamic_scaling ? 0 : by_vector + by_product;
    case Method::pipelined_cg:  // α·v and wᵀr, and q is a vector word; β·d, β·q and β·v
      return by_vector + words + (w.dynamic_scaling ? 0 : 2 * by_vector + by_product);
  }
  return 0;
}

int multipliers(const Architecture& a, const WordLengths& w) {
  const bool recurrence = w.method == Method::chronopoulos_gear || w.method == Method::pipelined_cg;
  const int product =
      a.rows_in_parallel * a.package * a.partitions * products(w.matrix_bits, w.vector_bits);
  const int vectors = ceil_div(std::int64_t{kVectorMultipliers} * a.nodes_per_clock *
                                   ceil_div(w.vector_bits, 18) * ceil_div(w.coefficient_bits, 18),
                               2);
  const int scalars = recurrence ? 1 : 0;  // β²·dᵀA·d, step by step
  return product + vectors + 3 * further_products(w) * a.nodes_per_clock + scalars;
}

Usage usage_of(const Device& d, const Architecture& a, const WordLengths& w, const Size& size) {
  Usage u;
  const Allocate add = [&u](const char* use, const char* type, int blocks) {
    u.allocations.push_back({use, type, blocks});
  };
  // A unit holds 1024 matrix words; words longer than 12 bits take more blocks side by side.
  const int unit_blocks = ceil_div(std::int64_t{kUnitWords} * w.matrix_bits, kM4kBits);
  // The rows of a node that are not worked on at once stand one behind the other.
  const int rows_a_memory = ceil_div(3, a.rows_in_parallel);
  const int units = ceil_div(size.packages * a.package * rows_a_memory, kUnitWords);
  add("matrix", "M4K", a.partitions * a.rows_in_parallel * units * unit_blocks);
  allocate_vectors(a, w, size, add);
  allocate_preconditioner(a, w, size.nodes, add);
  int index_bits = 1;
  while ((std::int64_t{1} << index_bits) < size.direction_nodes) ++index_bits;
  const int port_bits = a.partitions * nodes_in_package(a.package) * index_bits;
  add("index", "M-RAM", ceil_div(port_bits, kMRamPortBits));

  const auto used = [&u](const std::string& type) {
    int sum = 0;
    for (const Allocation& allocation : u.allocations) {
      if (allocation.type == type) sum += allocation.blocks;
    }
    return sum;
  };
  for (const char* type : {"M512", "M4K", "M-RAM"}) {
    const MemoryType* memory = d.memory(type);
    u.resources.push_back({type, used(type), memory == nullptr ? 0 : memory->blocks});
  }
  u.resources.push_back({"multipliers", multipliers(a, w), d.multipliers.front().count});
  return u;
}

}  // namespace

bool Usage::fits() const {
  return std::all_of(resources.begin(), resources.end(),
                     [](const Resource& r) { return r.used <= r.available; });
}

WordLengths word_lengths(const fixed::Settings& s) {
  WordLengths w;
  w.matrix_bits = s.matrix_bits;
  w.vector_bits = s.vector_bits;
  w.coefficient_bits = s.coefficient_bits;
  w.method = s.method;
  w.dynamic_scaling = s.dynamic_scaling;
  w.extrapolated = s.start == fixed::Start::extrapolated;
  w.stop_test = s.stop_residual > 0;
  return w;
}

Usage usage(const Device& device, const Architecture& a, const WordLengths& words,
            const Pattern& p) {
  return usage_of(
      device, a, words,
      {p.nodes_in_vectors(), p.nodes_in_direction(), packages_in_fullest_partition(a, p)});
}

int largest_mesh(const Device& device, const Architecture& a, const WordLengths& words,
                 const Pattern& p) {
  if (p.nodes() == 0) return 0;
  const std::int64_t packages = packages_in_fullest_partition(a, p);
  const auto fits = [&](int nodes) {
    const double times = static_cast<double>(nodes) / p.nodes();
    const auto scaled = [times](std::int64_t count) {
      return std::llround(times * static_cast<double>(count));
    };
    const Size size{static_cast<int>(scaled(p.nodes_in_vectors())),
                    static_cast<int>(scaled(p.nodes_in_direction())), scaled(packages)};
    return usage_of(device, a, words, size).fits();
  };
  // Usage grows with the mesh, so that the edge is found by halving.
  int low = 0;
  int high = 1 << 20;
  while (high - low > 1) {
    const int middle = low + (high - low) / 2;
    (fits(middle) ? low : high) = middle;
  }
  return low;
}

void require_fit(const Device& device, const Architecture& a, const WordLengths& words,
                 const Pattern& p) {
  const Usage u = usage(device, a, words, p);
  if (u.fits()) return;
  std::string message =
      "the " + device.name + " cannot hold this system of " + std::to_string(p.nodes()) + " nodes:";
  for (const Resource& r : u.resources) {
    if (r.used <= r.available) continue;
    message += message.back() == ':' ? " " : ", ";
    message += std::to_string(r.used) + " " + r.type + " of " + std::to_string(r.available);
  }
  const int nodes = largest_mesh(device, a, words, p);
  if (nodes > 0) {
    message += "; about " + std::to_string(nodes) + " nodes with such rows would fit";
  } else {
    message += "; no mesh fits: fewer partitions or a larger device would";
  }
  throw InputError("device", message);
}

}  // namespace hvp::accel
