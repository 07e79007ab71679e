#pragma once

#include <iosfwd>
#include <span>
#include <string_view>
#include <vector>

#include "models/sparse/block_matrix.h"

// NIST's Matrix Market exchange format (Boisvert, Pozo, Remington 1996), as Octave, SciPy and
// SuiteSparse read and write it. Numbers are written with the fewest digits that read back to the
// same bits.
namespace hvp::sparse {

// `matrix coordinate real symmetric` with the lower triangle where A equals its transpose to the
// last bit, `general` with all entries otherwise. Zeros inside blocks are written too: they are
// part of the pattern. `comment` is one line; empty writes none.
void write_matrix_market(std::ostream& out, const BlockMatrix& a, std::string_view comment = {});

// `matrix array real general` with one column.
void write_matrix_market(std::ostream& out, std::span<const double> vector,
                         std::string_view comment = {});

struct SquareMatrix {
  BlockMatrix matrix;
  // The rows in the file. If that is no multiple of three, `matrix` has one or two more rows,
  // uncoupled and with the mean diagonal, so that a zero on the right gives a zero.
  int rows = 0;
};

// Reads a `coordinate` matrix, real or integer, symmetric or general. `name` stands in messages.
// Every diagonal block and both of (i, j) and (j, i) are in the pattern. Throws InputError naming
// the line: no Matrix Market banner, a complex or pattern matrix, not square, not symmetric (to
// 1e-12 of the largest entry), an index out of range, an entry given twice, a number that is not
// finite, too few or too many entries, fewer entries than rows. Its messages are one printable
// line. Memory stays in proportion to the file.
SquareMatrix read_matrix_market(std::istream& in, std::string_view name);

// Reads a vector: `array` or `coordinate` with one column (or one row).
std::vector<double> read_matrix_market_vector(std::istream& in, std::string_view name);

}  // namespace hvp::sparse
