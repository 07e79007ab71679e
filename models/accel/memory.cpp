#include "models/accel/memory.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "models/accel/logic.h"
#include "models/accel/memory_blocks.h"
#include "models/accel/multipliers.h"

namespace hvp::accel {

namespace {

constexpr Role kRoles[] = {Role::matrix,  Role::index,          Role::copies,
                           Role::vectors, Role::preconditioner, Role::queue};

// What no device has is not told apart any more.
int counted(std::int64_t number) {
  return static_cast<int>(std::min<std::int64_t>(number, std::numeric_limits<int>::max()));
}

void allocate(const Device& device, const Architecture& a, const Structure& s, Usage& u) {
  const MemoryType& type = memory_for(device, a, s);
  const std::int64_t blocks = blocks_of(type, s, a);
  if (blocks < 0) u.obstacles.push_back({key_of(s.role), why_not(type, s, a)});
  u.allocations.push_back(
      {s.use, type.name, counted(std::max<std::int64_t>(blocks, 0)), s.memories, s.depth, s.width});
}

int blocks_used(const Usage& u, const std::string& type) {
  std::int64_t sum = 0;
  for (const Allocation& allocation : u.allocations) {
    if (allocation.type == type) sum += allocation.blocks;
  }
  return counted(sum);
}

Usage usage_of(const Device& device, const Architecture& a, const WordLengths& w,
               const SystemSize& size) {
  Usage u;
  for (const Structure& s : structures(a, w, size)) allocate(device, a, s, u);
  for (const MemoryType& type : device.memories) {
    u.resources.push_back({type.name, blocks_used(u, type.name), type.blocks});
  }
  u.resources.push_back(
      {"multipliers", counted(multipliers(device, a, w)), multiplier_mode(device, a).count});
  std::int64_t cells = 0;
  std::int64_t registers = 0;
  for (const LogicUse& use : logic(device, a, w, size)) {
    cells += use.cells;
    registers += use.registers;
  }
  u.resources.push_back({"logic", counted(cells), device.logic.cells});
  u.resources.push_back({"registers", counted(registers), device.logic.registers});
  return u;
}

}  // namespace

bool Usage::fits() const {
  return obstacles.empty() &&
         std::ranges::all_of(resources, [](const Resource& r) { return r.used <= r.available; });
}

void require_choices(const Device& device, const Architecture& a) {
  for (const Role role : kRoles) memory_for(device, a, role);
  multiplier_mode(device, a);
}

Usage usage(const Device& device, const Architecture& a, const WordLengths& words,
            const Pattern& p) {
  require_choices(device, a);
  return usage_of(device, a, words, system_size(a, p));
}

int largest_mesh(const Device& device, const Architecture& a, const WordLengths& words,
                 const Pattern& p) {
  if (p.nodes() == 0) return 0;
  const SystemSize size = system_size(a, p);
  const auto fits = [&](int nodes) {
    const double times = static_cast<double>(nodes) / p.nodes();
    const auto scaled = [times](std::int64_t count) {
      return std::llround(times * static_cast<double>(count));
    };
    const SystemSize other{static_cast<int>(scaled(size.nodes)),
                           static_cast<int>(scaled(size.direction_nodes)), scaled(size.packages),
                           size.longest_row};
    return usage_of(device, a, words, other).fits();
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

}  // namespace hvp::accel
