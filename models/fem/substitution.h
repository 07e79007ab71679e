#pragma once

#include <vector>

namespace hvp::fem {

// A sparse unit lower triangular matrix L, its diagonal left out: column j has the entries
// begin[j] … begin[j+1] - 1, their rows ascend. The pattern is that of a factor: the rows of a
// column are its first row r and a subset of the rows of column r.
struct TriangularFactor {
  const int* begin = nullptr;
  const int* row = nullptr;
  const double* value = nullptr;
};

// Solves L·y = b and Lᵀ·x = y in an order that keeps a processor busy: forwards several columns of
// equal pattern at once, backwards two branches of the elimination tree side by side, because one
// column is a chain of subtractions that wait for one another. The bits are those of the plain
// loops over columns: the terms of every entry are subtracted one by one, by ascending columns
// forwards and by ascending rows backwards.
//
// Two systems of one pattern can be solved in one pass, each with the bits that it has alone.
class Substitution {
 public:
  Substitution() = default;
  // `l` has `columns` columns; only its pattern is read.
  Substitution(const TriangularFactor& l, int columns);

  // Both work in place; `l` has the pattern of the constructor's.
  void forward(const TriangularFactor& l, double* x) const;
  void backward(const TriangularFactor& l, double* x) const;

  // The same for two systems, entry by entry side by side: l.value[2k] and x[2i] belong to one,
  // l.value[2k + 1] and x[2i + 1] to the other. Both arrays are aligned to 16 bytes.
  void forward_both(const TriangularFactor& l, double* x) const;
  void backward_both(const TriangularFactor& l, double* x) const;

 private:
  // Neighbouring columns whose rows below them are the same.
  struct Panel {
    int first = 0;
    int width = 0;
  };
  // `count` terms of one column, or of two at once. `from` is the column that starts before them,
  // `to` the one that ends behind them; -1: none.
  struct Stretch {
    struct Lane {
      int entry = -1;  // the first term; -1: this lane rests
      int from = -1;
      int to = -1;
    };
    int count = 0;
    Lane lane[2];
  };

  void form_panels(const TriangularFactor& l, int columns);
  void form_stretches(const TriangularFactor& l, int columns);
  template <class Entry>
  void forward_of(const TriangularFactor& l, Entry* x) const;
  template <class Entry>
  void backward_of(const TriangularFactor& l, Entry* x) const;

  std::vector<Panel> panels_;
  std::vector<Stretch> stretches_;
};

}  // namespace hvp::fem
