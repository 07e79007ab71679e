#include "models/accel/several_devices.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "models/accel/bits.h"
#include "models/accel/partition.h"
#include "models/config/input_error.h"
#include "models/fixed/settings.h"
#include "models/index.h"

namespace hvp::accel {

Links::Links(const Several& s, double engine_clock_hz)
    : topology_(s.topology),
      latency_(std::ceil(s.link_latency_s * engine_clock_hz - 1e-9)),
      bits_a_clock_(s.link_width * s.link_clock_hz / engine_clock_hz) {}

int Links::hops(int devices) const {
  return topology_ == Topology::ring ? devices / 2 : std::min(devices - 1, 1);
}

double Links::tail(int devices) const { return hops(devices) * latency_; }

// rows[source][hop]: what goes on at least so many hops, less one.
double Links::one_way_round(const Demand& demand, int direction, int bits_a_row) const {
  const int devices = static_cast<int>(demand.size());
  const int hops = devices / 2;
  const auto neighbour = [&](int device, int steps) {
    return ((device + direction * steps) % devices + devices) % devices;
  };
  std::vector<double> rows(at(devices * hops), 0.0);
  for (int source = 0; source < devices; ++source) {
    for (const auto& [needed_by, count] : demand[at(source)]) {
      double share = 0;  // of these rows that goes on, from the farthest hop inwards
      for (int hop = hops; hop >= 1; --hop) {
        const bool needed = ((needed_by >> neighbour(source, hop)) & 1U) != 0;
        if (needed) share = std::max(share, 2 * hop == devices ? 0.5 : 1.0);
        rows[at(source * hops + hop - 1)] += share * count;
      }
    }
  }
  // Word after word over the link behind each device: its own first, then what comes by.
  std::vector<double> free(at(devices), 0.0);
  std::vector<double> begun(at(devices), -latency_);  // of the message a hop earlier, by source
  double last = 0;
  for (int hop = 1; hop <= hops; ++hop) {
    for (int source = 0; source < devices; ++source) {
      const double sent = rows[at(source * hops + hop - 1)];
      if (sent == 0) continue;
      double& link = free[at(neighbour(source, hop - 1))];
      const double begin = std::max(link, begun[at(source)] + latency_);
      link = begin + clocks(sent * bits_a_row);
      begun[at(source)] = begin;
      last = std::max(last, link + latency_);
    }
  }
  return last;
}

double Links::exchange(const Demand& demand, int bits_a_row) const {
  // Between two devices both ways round are the same link.
  if (topology_ == Topology::ring && demand.size() > 2) {
    return std::max(one_way_round(demand, 1, bits_a_row), one_way_round(demand, -1, bits_a_row));
  }
  double most = 0;
  for (std::size_t source = 0; source < demand.size(); ++source) {
    for (std::size_t target = 0; target < demand.size(); ++target) {
      if (target == source) continue;
      double rows = 0;
      for (const auto& [needed_by, count] : demand[source]) {
        if (((needed_by >> target) & 1U) != 0) rows += count;
      }
      most = std::max(most, rows);
    }
  }
  return most > 0 ? clocks(most * bits_a_row) + latency_ : 0;
}

std::int64_t Links::reduction(int devices, int bits) const {
  if (devices < 2) return 0;
  const double message = clocks(bits);
  const double arrived = (hops(devices) - 1) * std::max(message, latency_) + message + latency_;
  const int adder_ranks = levels_over(devices);
  return static_cast<std::int64_t>(std::ceil(arrived)) + adder_ranks;
}

namespace {

std::int64_t rounded_up(double clocks) { return static_cast<std::int64_t>(std::ceil(clocks)); }

// Nodes a clock that the copies of the multiplied vector take from the links, while a pass reads
// and writes them and when they are idle. A node's three components go into three memories at once.
struct WritePorts {
  int beside_a_pass, idle;
};
WritePorts write_ports(const Architecture& a) {
  const int accesses = a.direction_banks * a.direction_accesses();
  const int write = a.direction_write_accesses();
  const int left = accesses - a.nodes_per_clock * (1 + write);
  return {std::max(0, left) / write, accesses / write};
}

std::vector<DeviceShare> shares_of(const Architecture& a, const Pattern& p,
                                   const std::vector<int>& device_of_row) {
  std::vector<DeviceShare> shares(at(a.several->devices));
  std::size_t first = 0;
  for (int row = 0; row < p.nodes(); ++row) {
    Pattern& own = shares[at(device_of_row[at(row)])].pattern;
    const auto blocks = static_cast<std::size_t>(p.blocks_in_row[at(row)]);
    own.blocks_in_row.push_back(p.blocks_in_row[at(row)]);
    if (!p.column.empty()) {
      const auto begin = p.column.begin() + static_cast<std::ptrdiff_t>(first);
      own.column.insert(own.column.end(), begin, begin + static_cast<std::ptrdiff_t>(blocks));
    }
    first += blocks;
  }
  return shares;
}

// Sets of devices that need each row: all others, or those whose rows touch it.
std::vector<std::uint64_t> needed_by(const Several& s, const Pattern& p,
                                     const std::vector<int>& device_of_row) {
  const std::uint64_t everyone =
      s.devices == kMostLinkedDevices ? ~std::uint64_t{0} : (std::uint64_t{1} << s.devices) - 1;
  const bool all = s.exchange == Exchange::all;
  std::vector<std::uint64_t> sets(p.blocks_in_row.size(), all ? everyone : 0);
  std::size_t k = 0;
  for (int row = 0; row < p.nodes() && !all; ++row) {
    for (int i = 0; i < p.blocks_in_row[at(row)]; ++i) {
      sets[at(p.column[k++])] |= std::uint64_t{1} << device_of_row[at(row)];
    }
  }
  for (std::size_t row = 0; row < sets.size(); ++row) {
    sets[row] &= ~(std::uint64_t{1} << device_of_row[row]);
  }
  return sets;
}

std::vector<int> devices_of_rows(const Architecture& a, const Pattern& p) {
  if (!a.several || a.several->devices < 2 || a.several->devices > kMostLinkedDevices) {
    throw std::invalid_argument("the architecture is not one of several devices");
  }
  const int devices = a.several->devices;
  if (p.nodes() < devices) {
    throw InputError("several.devices", "the system has " + std::to_string(p.nodes()) +
                                            " nodes: expected at most as many devices, found " +
                                            std::to_string(devices));
  }
  const bool halo = a.several->exchange == Exchange::halo;
  return halo ? metis_parts(a, p, devices) : deal_rows(a, p, devices);
}

}  // namespace

SeveralDevices::SeveralDevices(const Architecture& a, const Pattern& p)
    : architecture_(a),
      several_(a.several.value()),
      links_(several_, a.clock_hz),
      nodes_(p.nodes()),
      device_of_row_(devices_of_rows(a, p)),
      shares_(shares_of(a, p, device_of_row_)),
      demand_(shares_.size()) {
  const std::vector<std::uint64_t> sets = needed_by(several_, p, device_of_row_);
  for (std::size_t row = 0; row < sets.size(); ++row) {
    ++demand_[at(device_of_row_[row])][sets[row]];
    for (std::uint64_t left = sets[row]; left != 0; left &= left - 1) {
      ++shares_[static_cast<std::size_t>(std::countr_zero(left))].halo;
    }
  }
  int most_nodes = 0;
  for (DeviceShare& share : shares_) {
    share.pattern.vector_nodes = split() ? share.pattern.nodes() : nodes_;
    share.pattern.direction_nodes = share.pattern.nodes() + share.halo;
    most_nodes = std::max(most_nodes, share.pattern.nodes_in_vectors());
  }
  for (DeviceShare& share : shares_) share.units = unit_clocks(a, share.pattern, most_nodes);
}

Passes SeveralDevices::passes(const SolveWork& work) const {
  UnitClocks slowest = shares_.front().units;
  for (const DeviceShare& s : shares_) slowest.product = std::max(slowest.product, s.units.product);
  return passes_of(architecture_, slowest, work);
}

// Clocks beyond the pass that makes a vector, until every device has what it needs of it. Words
// leave as they are made where the copies have ports left to take them beside the pass; a pass of
// no clocks made it long ago.
std::int64_t SeveralDevices::direction_exchange(const Passes& pass, const SolveWork& work) const {
  const double transfer = links_.exchange(demand_, 3 * work.vector_bits);
  if (transfer == 0) return 0;  // no device's rows touch another's, or the links are free
  const WritePorts ports = write_ports(architecture_);
  int halo = 0;
  for (const DeviceShare& s : shares_) halo = std::max(halo, s.halo);
  const auto producing = static_cast<double>(pass.vectors.moving - architecture_.phase_clocks());
  const bool beside = pass.vectors.moving > 0 && ports.beside_a_pass > 0;
  const double written_beside = beside ? ports.beside_a_pass * producing : 0;
  const double writing = std::max(0.0, halo - written_beside) / ports.idle;
  const double sending = beside ? std::max(transfer - producing, links_.tail(devices())) : transfer;
  return rounded_up(std::max(sending, writing));
}

// The parts of A·d with the partial inner product behind them, beyond the product. They leave row
// by row; a memory of A·d takes a word from its own partition and one from a link.
std::int64_t SeveralDevices::product_exchange(const Passes& pass, const SolveWork& work) const {
  const double transfer = links_.exchange(demand_, 3 * fixed::Settings::kProductBits);
  int halo = 0;
  for (const DeviceShare& s : shares_) halo = std::max(halo, s.halo);
  const auto issue = static_cast<double>(pass.product - architecture_.phase_clocks());
  const double first = issue * architecture_.partitions * devices() / nodes_;
  const double producing = std::max(0.0, issue - first);
  const double writing = static_cast<double>(halo) / architecture_.nodes_per_clock - producing;
  const double sending = std::max(transfer - producing, links_.tail(devices()));
  const double scalar =
      static_cast<double>(links_.reduction(devices(), work.scalar_bits)) - links_.tail(devices());
  return rounded_up(std::max(sending, writing) + std::max(0.0, scalar));
}

SeveralCycles SeveralDevices::solve(const SolveWork& work) const {
  const Passes alone = passes(work);
  SeveralCycles cycles;
  cycles.alone = solve_cycles(alone, work);
  Passes linked = alone;
  if (!split()) {
    linked.product += product_exchange(alone, work);
    cycles.solve = solve_cycles(linked, work);
    return cycles;
  }
  // Two sums where ‖r‖ is not what β asks for, or where γ and δ are formed together; with each the
  // largest word, by which vectors are scaled.
  const bool two = work.method == fixed::Method::pipelined_cg ||
                   (work.stop_test && (work.method == fixed::Method::jacobi_pcg ||
                                       work.method == fixed::Method::block_jacobi_pcg));
  const int bits = (two ? 2 : 1) * work.scalar_bits + fixed::Settings::kProductBits;
  linked.reduction = links_.reduction(devices(), bits);
  const std::int64_t exchange = direction_exchange(alone, work);
  linked.product += exchange;
  cycles.solve = solve_cycles(linked, work);
  // The guess is exchanged before its product, with no pass beside.
  Passes idle = alone;
  idle.vectors.moving = 0;
  cycles.solve.setup += direction_exchange(idle, work) - exchange;
  return cycles;
}

std::int64_t SeveralDevices::exchanged_words() const {
  std::int64_t words = 0;
  for (const DeviceShare& s : shares_) words += 3 * std::int64_t{s.halo};
  return words;
}

std::int64_t SeveralDevices::node_update(const Pattern& p, int node,
                                         std::span<const int> neighbours,
                                         const fixed::Settings& settings) const {
  std::int64_t slowest = 0;
  for (int device = 0; device < devices(); ++device) {
    const bool owner = device_of(node) == device;
    std::int64_t clocks = architecture_.phase_clocks();
    if (owner) clocks += packages_of(architecture_, p.blocks_in_row[at(node)]);
    for (const int n : neighbours) {
      if (n != node && device_of(n) == device) {
        clocks += packages_of(architecture_, p.blocks_in_row[at(n)]);
      }
    }
    if (owner || !split()) clocks += node_inverse_cycles(architecture_, settings);
    slowest = std::max(slowest, clocks);
  }
  return slowest;
}

std::int64_t SeveralDevices::load(const Pattern& p, const fixed::Settings& settings) const {
  if (!split()) return load_cycles(architecture_, p, settings);
  std::int64_t slowest = 0;
  for (const DeviceShare& s : shares_) {
    slowest = std::max(slowest, load_cycles(architecture_, s.pattern, settings));
  }
  return slowest;
}

std::vector<Scaling> scaling(const Architecture& a, const Pattern& p, const SolveWork& work,
                             int most) {
  Architecture one = a;
  one.several.reset();
  const std::int64_t alone = solve_cycles(one, p, work).total();
  std::vector<Scaling> steps = {{1, alone, 0, 1}};
  Architecture many = a;
  if (!many.several) many.several.emplace();
  const int devices = std::min({most, p.nodes(), kMostLinkedDevices});
  for (many.several->devices = 2; many.several->devices <= devices; ++many.several->devices) {
    const SeveralCycles c = SeveralDevices(many, p).solve(work);
    steps.push_back({many.several->devices, c.solve.total(), c.link_clocks(),
                     static_cast<double>(alone) / static_cast<double>(c.solve.total())});
  }
  return steps;
}

double speed_up_limit(const Architecture& a, const Pattern& p, const SolveWork& work) {
  if (p.nodes() == 0) return 1;
  const VectorWork vectors = a.several ? a.several->vectors : Several().vectors;
  Architecture one = a;
  one.several.reset();
  const Pattern longest{{*std::ranges::max_element(p.blocks_in_row)}};
  const UnitClocks units = unit_clocks(one, longest, vectors == VectorWork::split ? 1 : p.nodes());
  const Passes pass = passes_of(one, units, work);
  return static_cast<double>(solve_cycles(one, p, work).total()) /
         static_cast<double>(solve_cycles(pass, work).total());
}

}  // namespace hvp::accel
