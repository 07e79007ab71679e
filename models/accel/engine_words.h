#pragma once

#include "models/accel/architecture.h"
#include "models/accel/structures.h"

namespace hvp::accel {

// 2^kRowBlockBits blocks of a row at most, for the matrix editor.
inline constexpr int kRowBlockBits = 6;

// The lengths in bits of the words and counters of engine.sv, as that file derives them from its
// parameters; nodes and packages are numbered with as many bits as a system of this size takes.
struct EngineWords {
  int node = 0;           // a node's number
  int lane_address = 0;   // in a lane's memories
  int bank_address = 0;   // in a memory of d
  int package = 0;        // a package's number, in its partition
  int queue = 0;          // a row's number in a queue of results
  int package_nodes = 0;  // nodes of a package: how many, not how long
  int index = 0;          // {last, phase, owner, nodes}
  int product = 0;        // of a matrix word and a vector word
  int sum = 0;            // an exact sum of a row
  int residual = 0;       // r, b and z
  int direction = 0;      // z where it becomes d
  int dropped = 0;        // bits of a sum that A·d drops
  int difference = 0;     // |b − A·d|
  int dot = 0;            // dᵀA·d
  int squares = 0;        // rᵀr
};
EngineWords engine_words(const Architecture& a, const WordLengths& w, const SystemSize& s);

}  // namespace hvp::accel
