#include "models/accel/memory.h"

#include <algorithm>
#include <array>
#include <cmath>

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

// Blocks for a vector with three components a node, each component in a memory of its own.
int vector_blocks(int nodes, int bits, int words_a_block) {
  return 3 * ceil_div(nodes, words_a_block) * ceil_div(bits, 16);
}

// Nodes, of three columns each, that a package touches at most. A row's first package starts with
// a node's first column; so do all others where whole nodes fill a package.
int nodes_in_package(int package) { return package % 3 == 0 ? package / 3 : (package + 1) / 3 + 1; }

Usage usage_of(const Architecture& a, const WordLengths& w, int nodes, std::int64_t packages) {
  Usage u;
  const auto add = [&u](const char* use, const char* type, int blocks) {
    u.allocations.push_back({use, type, blocks});
  };
  // A unit holds 1024 matrix words; words longer than 12 bits take more blocks side by side.
  const int unit_blocks = ceil_div(std::int64_t{kUnitWords} * w.matrix_bits, kM4kBits);
  const int units = ceil_div(packages * a.package, kUnitWords);
  add("matrix", "M4K", a.partitions * a.rows_in_parallel * units * unit_blocks);

  const int residual_bits = w.preconditioned ? 32 : w.vector_bits;
  const int direction_copies = a.direction_memory == DirectionMemory::two_copies ? 2 : 1;
  const auto vector = [nodes](int bits) { return vector_blocks(nodes, bits, kM4kWords); };
  add("d", "M4K", a.partitions * direction_copies * vector(w.vector_bits));
  add("x", "M4K", vector(w.vector_bits));
  add("b", "M4K", vector(residual_bits));
  add("r", "M4K", vector(residual_bits));
  add("A*d", "M4K", vector(32));
  if (w.preconditioned) {
    const bool m512 = a.preconditioner_memory == PreconditionerMemory::m512;
    for (const char* use : {"z", "inverse diagonal"}) {
      add(use, m512 ? "M512" : "M4K", vector_blocks(nodes, 32, m512 ? kM512Words : kM4kWords));
    }
  }
  int index_bits = 1;
  while ((std::int64_t{1} << index_bits) < nodes) ++index_bits;
  const int port_bits = a.partitions * nodes_in_package(a.package) * index_bits;
  add("index", "M-RAM", ceil_div(port_bits, kMRamPortBits));

  const int products = ceil_div(w.matrix_bits, 18) * ceil_div(w.vector_bits, 18);
  int multipliers = a.rows_in_parallel * a.package * a.partitions * products;
  multipliers += ceil_div(
      std::int64_t{kVectorMultipliers} * ceil_div(w.vector_bits, 18) * a.nodes_per_clock, 2);
  // z = P⁻¹·r keeps pace with r: three products of 32 × 32 bits, each four of 18 × 18, a node.
  if (w.preconditioned) multipliers += 3 * 4 * a.nodes_per_clock;

  const Device& d = device(a.device);
  const auto used = [&u](const std::string& type) {
    int sum = 0;
    for (const Allocation& allocation : u.allocations) {
      if (allocation.type == type) sum += allocation.blocks;
    }
    return sum;
  };
  u.resources = {{"M512", used("M512"), d.m512},
                 {"M4K", used("M4K"), d.m4k},
                 {"M-RAM", used("M-RAM"), d.m_ram},
                 {"multipliers", multipliers, d.multipliers}};
  return u;
}

}  // namespace

const Device& device(DeviceName name) {
  static const std::array<Device, 2> devices = {{
      {"EP2S60", 329, 255, 2, 144, "thesis Table 5.1"},
      {"EP2S180", 930, 768, 9, 384, "Stratix II device handbook, table 1-1"},
  }};
  return devices.at(static_cast<std::size_t>(name));
}

bool Usage::fits() const {
  return std::all_of(resources.begin(), resources.end(),
                     [](const Resource& r) { return r.used <= r.available; });
}

Usage usage(const Architecture& a, const WordLengths& words, const Pattern& p) {
  return usage_of(a, words, p.nodes(), packages_in_fullest_partition(a, p));
}

int largest_mesh(const Architecture& a, const WordLengths& words, const Pattern& p) {
  if (p.nodes() == 0) return 0;
  const double packages_a_node =
      static_cast<double>(packages_in_fullest_partition(a, p)) / p.nodes();
  const auto fits = [&](int nodes) {
    const auto packages = std::llround(packages_a_node * nodes);
    return usage_of(a, words, nodes, packages).fits();
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

void require_fit(const Architecture& a, const WordLengths& words, const Pattern& p) {
  const Usage u = usage(a, words, p);
  if (u.fits()) return;
  std::string message = "the " + device(a.device).name + " cannot hold this system of " +
                        std::to_string(p.nodes()) + " nodes:";
  for (const Resource& r : u.resources) {
    if (r.used <= r.available) continue;
    message += message.back() == ':' ? " " : ", ";
    message += std::to_string(r.used) + " " + r.type + " of " + std::to_string(r.available);
  }
  const int nodes = largest_mesh(a, words, p);
  if (nodes > 0) {
    message += "; about " + std::to_string(nodes) + " nodes with such rows would fit";
  } else {
    message += "; no mesh fits: fewer partitions or a larger device would";
  }
  throw InputError("device", message);
}

}  // namespace hvp::accel
