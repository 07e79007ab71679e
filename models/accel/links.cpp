#include "models/accel/links.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "models/accel/bits.h"
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

}  // namespace hvp::accel
