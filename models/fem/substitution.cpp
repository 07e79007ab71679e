#include "models/fem/substitution.h"

#include <algorithm>
#include <cstddef>
#include <queue>
#include <utility>

#include "models/index.h"

namespace hvp::fem {

namespace {

constexpr int kWidest = 4;  // columns of a panel: their entries of x stay in registers

// Two doubles in one register, of every processor that has such; in memory two doubles.
struct __attribute__((may_alias)) Pair {
  double __attribute__((vector_size(16))) entry;
  friend Pair operator*(const Pair& a, const Pair& b) { return {a.entry * b.entry}; }
  Pair& operator-=(const Pair& other) {
    entry -= other.entry;
    return *this;
  }
};

// The columns of a panel: what is known of x after them leaves the rows below.
template <int kWidth, class Entry>
void eliminate(const TriangularFactor& l, int first, const Entry* value, Entry* x) {
  const Entry* below[kWidth];
  Entry known[kWidth];
  for (int c = 0; c < kWidth; ++c) {
    below[c] = value + l.begin[first + c];
    known[c] = x[first + c];
  }
  for (int c = 0; c < kWidth; ++c) {
    for (int d = c + 1; d < kWidth; ++d) known[d] -= *below[c]++ * known[c];
  }
  for (int c = 1; c < kWidth; ++c) x[first + c] = known[c];
  const int* const row = l.row + l.begin[first + kWidth - 1];
  const int rows = l.begin[first + kWidth] - l.begin[first + kWidth - 1];
  for (int i = 0; i < rows; ++i) {
    Entry sum = x[row[i]];
    for (int c = 0; c < kWidth; ++c) sum -= below[c][i] * known[c];
    x[row[i]] = sum;
  }
}

}  // namespace

Substitution::Substitution(const TriangularFactor& l, int columns) {
  form_panels(l, columns);
  form_stretches(l, columns);
}

void Substitution::form_panels(const TriangularFactor& l, int columns) {
  const auto rows_of = [&](int column) { return l.begin[column + 1] - l.begin[column]; };
  for (int j = 0; j < columns; ++j) {
    const bool joins =
        j > 0 && panels_.back().width < kWidest && rows_of(j - 1) == rows_of(j) + 1 &&
        l.row[l.begin[j - 1]] == j &&
        std::equal(l.row + l.begin[j], l.row + l.begin[j + 1], l.row + l.begin[j - 1] + 1);
    if (joins) {
      ++panels_.back().width;
    } else {
      panels_.push_back({.first = j, .width = 1});
    }
  }
}

// Backwards a column can start when the one that its first row names, its parent, has ended; the
// columns of all its other rows are ancestors. Of those that can, the one with the longest way
// down to a leaf is taken first.
void Substitution::form_stretches(const TriangularFactor& l, int columns) {
  const auto terms_of = [&](int column) { return l.begin[column + 1] - l.begin[column]; };
  std::vector<std::vector<int>> children(at(columns) + 1);  // the last: of nobody
  std::vector<int> way(at(columns), 0);
  for (int j = 0; j < columns; ++j) {
    way[at(j)] += terms_of(j);
    const int parent = terms_of(j) > 0 ? l.row[l.begin[j]] : columns;
    children[at(parent)].push_back(j);
    if (parent < columns) way[at(parent)] = std::max(way[at(parent)], way[at(j)]);
  }
  std::priority_queue<std::pair<int, int>> ready;
  const auto release = [&](int column) {
    for (const int child : children[at(column)]) ready.emplace(way[at(child)], child);
  };
  release(columns);

  struct Running {
    int column = -1;
    int left = 0;
  } running[2];
  for (;;) {
    Stretch stretch;
    for (int lane = 0; lane < 2; ++lane) {
      Running& now = running[lane];
      while (now.left == 0 && !ready.empty()) {
        now = {ready.top().second, terms_of(ready.top().second)};
        ready.pop();
        stretch.lane[lane].from = now.column;
        if (now.left == 0) release(now.column);  // a root: nothing to subtract
      }
      if (now.left == 0) stretch.lane[lane].from = -1;
    }
    const int most = std::max(running[0].left, running[1].left);
    if (most == 0) return;
    const int least = std::min(running[0].left, running[1].left);
    stretch.count = least > 0 ? least : most;
    for (int lane = 0; lane < 2; ++lane) {
      Running& now = running[lane];
      if (now.left == 0) continue;
      stretch.lane[lane].entry = l.begin[now.column + 1] - now.left;
      now.left -= stretch.count;
      if (now.left > 0) continue;
      stretch.lane[lane].to = now.column;
      release(now.column);
    }
    stretches_.push_back(stretch);
  }
}

template <class Entry>
void Substitution::forward_of(const TriangularFactor& l, Entry* x) const {
  static_assert(kWidest == 4);
  const auto* const value = reinterpret_cast<const Entry*>(l.value);
  for (const Panel& panel : panels_) {
    switch (panel.width) {
      case 1:
        eliminate<1>(l, panel.first, value, x);
        break;
      case 2:
        eliminate<2>(l, panel.first, value, x);
        break;
      case 3:
        eliminate<3>(l, panel.first, value, x);
        break;
      default:
        eliminate<4>(l, panel.first, value, x);
        break;
    }
  }
}

template <class Entry>
void Substitution::backward_of(const TriangularFactor& l, Entry* x) const {
  const auto* const value = reinterpret_cast<const Entry*>(l.value);
  Entry sum[2] = {};
  for (const Stretch& stretch : stretches_) {
    const auto& [one, other] = stretch.lane;
    if (one.from >= 0) sum[0] = x[one.from];
    if (other.from >= 0) sum[1] = x[other.from];
    if (one.entry >= 0 && other.entry >= 0) {
      const Entry* const one_value = value + one.entry;
      const Entry* const other_value = value + other.entry;
      const int* const one_row = l.row + one.entry;
      const int* const other_row = l.row + other.entry;
      Entry one_sum = sum[0];
      Entry other_sum = sum[1];
      for (int i = 0; i < stretch.count; ++i) {
        one_sum -= one_value[i] * x[one_row[i]];
        other_sum -= other_value[i] * x[other_row[i]];
      }
      sum[0] = one_sum;
      sum[1] = other_sum;
    } else {
      const int lane = one.entry >= 0 ? 0 : 1;
      const Entry* const lane_value = value + stretch.lane[lane].entry;
      const int* const row = l.row + stretch.lane[lane].entry;
      Entry lane_sum = sum[lane];
      for (int i = 0; i < stretch.count; ++i) lane_sum -= lane_value[i] * x[row[i]];
      sum[lane] = lane_sum;
    }
    if (one.to >= 0) x[one.to] = sum[0];
    if (other.to >= 0) x[other.to] = sum[1];
  }
}

void Substitution::forward(const TriangularFactor& l, double* x) const { forward_of(l, x); }

void Substitution::backward(const TriangularFactor& l, double* x) const { backward_of(l, x); }

void Substitution::forward_both(const TriangularFactor& l, double* x) const {
  forward_of(l, reinterpret_cast<Pair*>(x));
}

void Substitution::backward_both(const TriangularFactor& l, double* x) const {
  backward_of(l, reinterpret_cast<Pair*>(x));
}

}  // namespace hvp::fem
