#pragma once

#include <array>
#include <cstddef>
#include <map>

#include "models/accel/cycles.h"

namespace hvp::accel::test {

// The thesis' pattern with its columns: nodes of a face-centred cubic lattice, each coupled with
// its twelve neighbours, so that an inner row has 13 blocks, 39 columns, five packages of eight
// (§5.3 counts 36 columns on average).
inline Pattern lattice(int cells_x, int cells_y, int cells_z) {
  std::map<std::array<int, 3>, int> number;  // in half edges; the sum of a node's is even
  for (int z = 0; z < 2 * cells_z; ++z) {
    for (int y = 0; y < 2 * cells_y; ++y) {
      for (int x = 0; x < 2 * cells_x; ++x) {
        if ((x + y + z) % 2 == 0) number.emplace(std::array<int, 3>{x, y, z}, 0);
      }
    }
  }
  int next = 0;
  for (auto& [place, index] : number) index = next++;
  Pattern p;
  for (const auto& [place, index] : number) {
    int blocks = 0;
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dz = -1; dz <= 1; ++dz) {
          const auto found = number.find({place[0] + dx, place[1] + dy, place[2] + dz});
          if (found == number.end()) continue;
          p.column.push_back(found->second);
          ++blocks;
        }
      }
    }
    p.blocks_in_row.push_back(blocks);
  }
  return p;
}

}  // namespace hvp::accel::test
