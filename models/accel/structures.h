#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/accel/architecture.h"
#include "models/accel/cycles.h"
#include "models/fixed/settings.h"

namespace hvp::accel {

// The solver's settings that decide what is stored and multiplied. CG keeps b and r in vector
// words; with a preconditioner they have 32 bits, and z and P⁻¹ too (§4.4).
struct WordLengths {
  int matrix_bits = 12;
  int vector_bits = 16;
  int coefficient_bits = 16;
  int scalar_bits = 64;
  fixed::Method method = fixed::Method::cg;
  bool dynamic_scaling = true;
  bool extrapolated = false;  // the solution before the last one is kept
  bool stop_test = false;     // ‖r‖ and ‖b‖ are formed

  bool preconditioned() const {
    return method == fixed::Method::jacobi_pcg || method == fixed::Method::block_jacobi_pcg;
  }
};
WordLengths word_lengths(const fixed::Settings& settings);

// The sizes of a system on which the engine's structures depend.
struct SystemSize {
  int nodes = 0;              // nodes of the vectors
  int direction_nodes = 0;    // nodes of the multiplied vector: more if devices share the rows
  std::int64_t packages = 0;  // packages of the fullest partition
  int longest_row = 0;        // blocks
};
SystemSize system_size(const Architecture& a, const Pattern& p);

// The role of a structure; the keys matrix_memory, index_memory … choose a memory type for each.
enum class Role { matrix, index, copies, vectors, preconditioner, queue };

// The accesses to a structure's memory in a clock.
enum class Access {
  stream,      // one address; written only while nothing is read
  read_write,  // one address is read and another one is written
  anywhere,    // `accesses` reads or writes, each of an address of its own
};

// The engine's memories of one shape and use, before they are put into blocks.
struct Structure {
  std::string use;  // "matrix", "d", "x" …
  Role role = Role::vectors;
  std::int64_t memories = 1;
  std::int64_t depth = 0;  // words of each
  std::int64_t width = 0;  // bits of a word
  Access access = Access::read_write;
  int accesses = 1;  // a clock, for Access::anywhere
};

// All structures of the engine (thesis §5.4 and §5.6; vp/fpga/engine has the same ones):
//   matrix  PL3 · PL1 memories of a package's words side by side (Fig. 5.8), read one package a
//           clock; rows of a node that do not go at once stand one behind the other
//   index   one memory for all partitions: the nodes of a package, and a bit that ends a row where
//           rows differ in length (s = 0)
//   d       PL3 copies, or twice as many, each component dealt to banks; four reads a clock or two
//   x, b, r, q, z, P⁻¹  L memories a component, so that L nodes are read and written in a clock
//   results rows that a partition has finished and the vector unit not yet taken: exact sums, and
//           the words of d at that node; with symmetric storage the partial sums of every partition
//           instead
std::vector<Structure> structures(const Architecture& a, const WordLengths& w, const SystemSize& s);

// The bits of an exact sum of a row: those of a product, and one for every doubling of the row's
// length.
int row_sum_bits(const WordLengths& w, int longest_row);

// The most nodes, of three columns each, that a package touches. A row's first package starts with
// a node's first column; so do all others if whole nodes fill a package.
constexpr int nodes_in_package(int package) {
  return package % 3 == 0 ? package / 3 : (package + 1) / 3 + 1;
}

}  // namespace hvp::accel
