#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <unistd.h>

#include "app/devices/devices.h"
#include "app/scene/scene.h"
#include "models/accel/board.h"
#include "models/config/input_error.h"
#include "models/mesh/node_search.h"
#include "vp/fpga/register_bank.h"

namespace hvp::app {

namespace {

// The nodes of the coarse mesh. It takes a few tenths of a second, and its rows and the share of
// its anchored nodes differ from those of a finer mesh by less than a factor of two.
constexpr int kCoarse = 500;
constexpr int kWorthwhile = 10 * kCoarse;
constexpr double kByFar = 2;

// The properties of a coarse mesh that predict those of a finer one.
struct Sample {
  double active = 0;  // nodes of the system, of each node of the mesh
  accel::BoardClocks board;
};

// Returns nothing if the coarse mesh cannot be made or its rows do not suit the architecture; the
// wanted mesh may still be possible.
std::optional<Sample> sample(const Scenario& s, const Progress& progress) {
  Scenario coarse = s;
  coarse.object.mesh.nodes = kCoarse;
  // A small region has no element of a coarse mesh, and the size does not depend on it.
  coarse.object.regions.clear();
  // Prescribed displacements change the size of the system; other loads do not.
  coarse.loads = {};
  coarse.loads.prescribed = s.loads.prescribed;
  try {
    const std::unique_ptr<fem::Body> body = make_body(coarse, progress);
    const sparse::BlockMatrix& k = body->stiffness();
    return Sample{
        static_cast<double>(body->active_nodes()) / static_cast<double>(body->mesh().nodes.size()),
        accel::BoardClocks(s.accelerator, accel::pattern_of(k.row_begin, k.column))};
  } catch (const InputError&) {
    return std::nullopt;
  }
}

void require_room_on_board(const Scenario& s, const accel::Device& device,
                           const Progress& progress) {
  if (s.object.mesh.nodes < kWorthwhile) return;
  const std::optional<Sample> found = sample(s, progress);
  if (!found) return;
  const accel::WordLengths words = accel::word_lengths(s.solver);
  const int largest = accel::largest_mesh_of_board(device, s.accelerator, words, found->board);
  if (largest == 0) {
    // Something other than memory does not fit then.
    try {
      accel::require_board_fit(device, s.accelerator, words, found->board, devices::all_built_in());
    } catch (const InputError& e) {
      throw InputError("accelerator." + e.key(), e.what());
    }
  }
  const double nodes = (1 - mesh::kAcceptedDeviation) * s.object.mesh.nodes * found->active;
  const auto in_mesh = [&](double in_system) {
    return static_cast<std::int64_t>(in_system / found->active);
  };
  if (nodes > kByFar * largest) {
    throw InputError(
        "accelerator.device",
        fmt::format("the {} cannot hold a system of some {:.0f} nodes; what fits: about "
                    "{} nodes (object.mesh.nodes = {})",
                    device.name, nodes, largest, in_mesh(largest)));
  }
  const vp::Capacity registers;
  if (nodes > kByFar * static_cast<double>(registers.nodes)) {
    throw InputError(
        "object.mesh.nodes",
        fmt::format("the board's registers have room for {} nodes (docs/registers.md), "
                    "the system has some {:.0f}: expected at most about {}",
                    registers.nodes, nodes, in_mesh(registers.nodes)));
  }
}

// The memory of a factor grows with the nodes to the power of 1.5. Measured with the thesis' sphere
// at 1000, 2000 and 4000 nodes: 7, 20 and 60 MB.
double factor_bytes(double nodes) { return 235 * std::pow(nodes, 1.5); }
double nodes_of_factor(double bytes) { return std::pow(bytes / 235, 2.0 / 3.0); }

// The number of factors: those of [reference], true and rounded, and that of the host's own solve.
int factors(const Scenario& s) {
  const bool factorised = s.host.solver != host::SolvedBy::board &&
                          s.host.solver != host::SolvedBy::cg &&
                          s.host.solver != host::SolvedBy::steps;
  return (s.reference ? 2 : 0) + (factorised ? 1 : 0);
}

double memory_bytes() {
  return static_cast<double>(::sysconf(_SC_PHYS_PAGES)) *
         static_cast<double>(::sysconf(_SC_PAGESIZE));
}

// Refuses a dense inverse that this machine has no room for. That of the nodes of the surface is
// smaller, by how much only the mesh tells.
void require_room_for_inverse(const Scenario& s) {
  if (s.host.solver != host::SolvedBy::inverse) return;
  const double entry = s.host.precision == host::Precision::single_precision ? 4 : 8;
  const double bytes = entry * std::pow(3.0 * s.object.mesh.nodes, 2);
  const double room = memory_bytes() / 2;
  if (bytes <= room) return;
  throw InputError(
      "object.mesh.nodes",
      fmt::format("the inverse of {} nodes takes about {:.0f} GB, and there is room for {:.0f} GB: "
                  "expected at most about {:.0f} nodes, or host.solver = \"condensed\" or "
                  "\"cholesky\"",
                  s.object.mesh.nodes, bytes * 1e-9, room * 1e-9, std::sqrt(room / entry) / 3));
}

void require_room_on_host(const Scenario& s) {
  require_room_for_inverse(s);
  const int count = factors(s);
  if (count == 0) return;
  // Entries of a factor are counted in 32 bits, and take a number and an index.
  constexpr double kLargest = 2147483647.0 * 12;
  const double room = std::min(kLargest, memory_bytes() / count);
  if (factor_bytes(s.object.mesh.nodes) <= room) return;
  throw InputError(
      "object.mesh.nodes",
      fmt::format(
          "the host's Cholesky factors of {} nodes take about {:.0f} GB each, and there is "
          "room for {:.0f} GB: expected at most about {:.0f} nodes, or host.solver = \"cg\" "
          "without [reference]",
          s.object.mesh.nodes, factor_bytes(s.object.mesh.nodes) * 1e-9, room * 1e-9,
          nodes_of_factor(room)));
}

}  // namespace

void require_plausible_size(const Scenario& s, const accel::Device& device,
                            const Progress& progress) {
  if (s.host.solver == host::SolvedBy::board) {
    require_room_on_board(s, device, progress);
  } else {
    require_room_on_host(s);
  }
}

}  // namespace hvp::app
