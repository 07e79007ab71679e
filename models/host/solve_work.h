#pragma once

namespace hvp::host {

// What a solve on a host does, apart from where. One rate cannot price it: a dense product runs as
// fast as its matrix arrives, a sparse one gathers its operands, and a triangular solve mostly
// waits for its last subtraction. Processor (processor.h) and Gpu (gpu.h) price it.
struct SolveWork {
  // Additions, multiplications, divisions and comparisons.
  double dense = 0;         // dense products, and vector operations
  double dense_single = 0;  // the same in single precision
  double sparse = 0;        // products with A, and what is done to one number at a time
  double triangular = 0;    // with sparse factors: to make them, and to solve with them
  // Read and written of matrices, factors and vectors.
  double bytes = 0;
  // The parts of the solve of which each needs all of the one before: where several workers solve,
  // they wait for each other so often.
  int barriers = 0;
  int calls = 0;  // solves, one after the other; 0: one

  double operations() const { return dense + dense_single + sparse + triangular; }

  SolveWork& operator+=(const SolveWork& other) {
    dense += other.dense;
    dense_single += other.dense_single;
    sparse += other.sparse;
    triangular += other.triangular;
    bytes += other.bytes;
    barriers += other.barriers;
    calls += other.calls;
    return *this;
  }
  friend SolveWork operator+(SolveWork a, const SolveWork& b) { return a += b; }
  friend SolveWork operator*(int times, const SolveWork& a) {
    return {times * a.dense, times * a.dense_single, times * a.sparse, times * a.triangular,
            times * a.bytes, times * a.barriers,     times * a.calls};
  }
};

// What a solver keeps and moves, in bytes.
struct SolveMemory {
  double kept = 0;         // all that it keeps between frames
  double working_set = 0;  // the part that every frame touches, which decides the tier of memory
  double right_hand_side = 0;
  double solution = 0;
  double set_up = 0;  // that the set-up touches again and again: the factors
};

}  // namespace hvp::host
