#include "models/accel/memory.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "models/accel/bits.h"
#include "models/accel/engine_logic.h"
#include "models/accel/multipliers.h"
#include "models/config/input_error.h"

namespace hvp::accel {

namespace {

constexpr std::int64_t kPorts = 2;  // of every block of every device so far

// A port's bits with those of its parity that can hold data: a port has its share of them where
// that is a whole bit.
std::int64_t with_parity(const MemoryType& type, std::int64_t width, bool used) {
  const std::int64_t share = width * type.parity_bits;
  return used && share % type.bits == 0 ? width + share / type.bits : width;
}

// Times the engine's clock that a memory has to run at.
std::int64_t pumping(const Structure& s) {
  return s.access == Access::anywhere ? ceil_div(s.accesses, kPorts) : 1;
}

bool fast_enough(const MemoryType& type, const Structure& s, const Architecture& a) {
  return static_cast<double>(pumping(s)) * a.clock_hz <= type.clock_hz;
}

const std::string& choice_of(const Architecture& a, Role role) {
  switch (role) {
    case Role::matrix:
      return a.matrix_memory;
    case Role::index:
      return a.index_memory;
    case Role::copies:
      return a.copies_memory;
    case Role::vectors:
      return a.vector_memory;
    case Role::preconditioner:
      return a.preconditioner_memory;
    case Role::queue:
      break;
  }
  return a.queue_memory;
}

std::int64_t stream_bits(const MemoryType& type) {
  return std::max<std::int64_t>(type.read_write_bits, kPorts * type.two_port_bits);
}

// Gives most bits a clock in all its blocks, of those with two ports that read anywhere, if any
// has.
const MemoryType& widest(const Device& device) {
  const auto rank = [](const MemoryType& type) {
    return std::pair(type.two_port_bits > 0, type.blocks * stream_bits(type));
  };
  return *std::ranges::max_element(device.memories, {}, rank);
}

}  // namespace

const char* key_of(Role role) {
  switch (role) {
    case Role::matrix:
      return "matrix_memory";
    case Role::index:
      return "index_memory";
    case Role::copies:
      return "copies_memory";
    case Role::vectors:
      return "vector_memory";
    case Role::preconditioner:
      return "preconditioner_memory";
    case Role::queue:
      break;
  }
  return "queue_memory";
}

std::vector<BlockShape> shapes(const MemoryType& type, const Structure& s, const Architecture& a) {
  std::vector<BlockShape> result;
  if (!fast_enough(type, s, a)) return result;
  const std::int64_t one_port = s.access == Access::anywhere
                                    ? type.two_port_bits
                                    : std::max(type.read_write_bits, type.two_port_bits);
  for (std::int64_t width = type.narrowest_bits; width <= one_port; width *= 2) {
    result.push_back({type.bits / width, with_parity(type, width, a.parity_bits)});
  }
  if (s.access != Access::stream) return result;
  for (std::int64_t width = type.narrowest_bits; width <= type.two_port_bits; width *= 2) {
    result.push_back(
        {type.bits / (kPorts * width), kPorts * with_parity(type, width, a.parity_bits)});
  }
  return result;
}

std::int64_t blocks_of(const MemoryType& type, const Structure& s, const Architecture& a) {
  std::int64_t fewest = -1;
  for (const BlockShape& shape : shapes(type, s, a)) {
    if (shape.depth == 0) continue;
    const std::int64_t blocks = ceil_div(s.width, shape.width) * ceil_div(s.depth, shape.depth);
    if (fewest < 0 || blocks < fewest) fewest = blocks;
  }
  return fewest < 0 ? fewest : fewest * s.memories;
}

std::string why_not(const MemoryType& type, const Structure& s, const Architecture& a) {
  if (s.access == Access::anywhere && type.two_port_bits == 0) {
    return "the " + type.name + " has no two ports that read anywhere, as " + s.use + " needs";
  }
  if (!fast_enough(type, s, a)) {
    return s.use + " has to run at " + std::to_string(pumping(s)) + " times the clock, " +
           std::to_string(
               static_cast<std::int64_t>(static_cast<double>(pumping(s)) * a.clock_hz / 1e6)) +
           " MHz, and the limit of the " + type.name + " is " +
           std::to_string(static_cast<std::int64_t>(type.clock_hz / 1e6)) + " MHz";
  }
  return {};
}

const MemoryType& memory_for(const Device& device, const Architecture& a, Role role) {
  const std::string& choice = choice_of(a, role);
  const auto& types = device.memories;
  if (choice == "auto") {
    if (role == Role::index) return *std::ranges::max_element(types, {}, &MemoryType::bits);
    if (role == Role::queue) return *std::ranges::min_element(types, {}, &MemoryType::bits);
    return widest(device);
  }
  if (const MemoryType* named = device.memory(choice)) return *named;
  std::string names = "auto";
  for (const MemoryType& type : types) names += ", " + type.name;
  throw InputError(key_of(role),
                   "the " + device.name + " has " + names + ": found \"" + choice + "\"");
}

const MemoryType& memory_for(const Device& device, const Architecture& a, const Structure& s) {
  const MemoryType& type = memory_for(device, a, s.role);
  const bool too_few = s.role == Role::index && blocks_of(type, s, a) > type.blocks;
  return too_few && a.index_memory == "auto" ? widest(device) : type;
}

namespace {

constexpr Role kRoles[] = {Role::matrix,  Role::index,          Role::copies,
                           Role::vectors, Role::preconditioner, Role::queue};

// Sizes beyond every device are not told apart any more.
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

}  // namespace

bool Usage::fits() const {
  return obstacles.empty() &&
         std::ranges::all_of(resources, [](const Resource& r) { return r.used <= r.available; });
}

void require_choices(const Device& device, const Architecture& a) {
  for (const Role role : kRoles) memory_for(device, a, role);
  multiplier_mode(device, a);
}

Usage usage(const Device& device, const Architecture& a, const WordLengths& w,
            const SystemSize& size) {
  require_choices(device, a);
  Usage u;
  for (const Structure& s : structures(a, w, size)) allocate(device, a, s, u);
  for (const MemoryType& type : device.memories) {
    u.resources.push_back({type.name, blocks_used(u, type.name), type.blocks});
  }
  u.resources.push_back(
      {"multipliers", counted(multipliers(device, a, w)), multiplier_mode(device, a).count});
  const UnitLogic needed = logic_of_device(device, logic(device, a, w, size));
  u.resources.push_back({"logic", counted(needed.tables), device.logic.cells});
  u.resources.push_back({"registers", counted(needed.registers), device.logic.registers});
  return u;
}

Usage usage(const Device& device, const Architecture& a, const WordLengths& words,
            const Pattern& p) {
  return usage(device, a, words, system_size(a, p));
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
    return usage(device, a, words, other).fits();
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
