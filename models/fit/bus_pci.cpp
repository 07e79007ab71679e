#include "models/fit/bus_pci.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace hvp::fit {

namespace {

// As link::Pci declares them.
constexpr int kLongestBurst = 4096;
constexpr int kMostOverhead = 64;
constexpr int kLeastOverhead = 2;
constexpr int kMostWaits = 16;
constexpr double kLongestBusLatency = 1e-3;  // s

constexpr double kAsGood = 0.005;   // of the bandwidth
constexpr double kNotEqual = 0.05;  // likewise: to be told

// Of whole bursts with so many clocks that carry no data.
double bandwidth(const link::Pci& pci, int overhead) {
  const double clocks = overhead + static_cast<double>(pci.burst_bytes) / pci.width_bytes();
  return pci.burst_bytes / (clocks * static_cast<double>(pci.clock_period_ps()) * 1e-12);
}

double deviation(const link::Pci& pci, const std::optional<Link>& read,
                 const std::optional<Link>& write) {
  double worst = 0;
  if (read) worst = std::abs(std::log(read_bandwidth(pci) / read->bandwidth));
  if (write) worst = std::max(worst, std::abs(std::log(write_bandwidth(pci) / write->bandwidth)));
  return worst;
}

// Keys that differ, and, below one, by how much.
double change(const link::Pci& a, const link::Pci& base) {
  double keys = a.kind == base.kind ? 0 : 1;
  double size = 0;
  if (a.burst_bytes != base.burst_bytes) {
    ++keys;
    size += std::abs(std::log2(static_cast<double>(a.burst_bytes) / base.burst_bytes)) / 10;
  }
  if (a.overhead_clocks != base.overhead_clocks) {
    ++keys;
    size += std::abs(a.overhead_clocks - base.overhead_clocks) / static_cast<double>(kMostOverhead);
  }
  if (a.read_wait_clocks != base.read_wait_clocks) {
    ++keys;
    size += std::abs(a.read_wait_clocks - base.read_wait_clocks) / static_cast<double>(kMostWaits);
  }
  return keys + size / 4;
}

std::vector<link::Pci> all(const link::Pci& base, bool reads) {
  std::vector<link::Pci> settings;
  for (const link::PciKind kind : {link::PciKind::pci_32_33, link::PciKind::pci_32_66,
                                   link::PciKind::pci_64_66, link::PciKind::pci_x_133}) {
    link::Pci pci = base;
    pci.kind = kind;
    for (pci.burst_bytes = pci.width_bytes(); pci.burst_bytes <= kLongestBurst;
         pci.burst_bytes *= 2) {
      for (pci.overhead_clocks = kLeastOverhead; pci.overhead_clocks <= kMostOverhead;
           ++pci.overhead_clocks) {
        if (!reads) {
          settings.push_back(pci);
          continue;
        }
        for (pci.read_wait_clocks = 0; pci.read_wait_clocks <= kMostWaits; ++pci.read_wait_clocks) {
          settings.push_back(pci);
        }
        pci.read_wait_clocks = base.read_wait_clocks;
      }
    }
  }
  return settings;
}

void set_latency(const char* name, const Link& measured, double& latency,
                 std::vector<std::string>& warnings) {
  latency = std::clamp(measured.latency_s, 0.0, kLongestBusLatency);
  if (latency == measured.latency_s) return;
  warnings.push_back(fmt::format("{}_latency: {:g} us measured, {:g} us is the most that [bus] has",
                                 name, measured.latency_s * 1e6, latency * 1e6));
}

void tell(const char* name, double measured, double modelled, std::vector<std::string>& warnings) {
  if (std::abs(modelled / measured - 1) <= kNotEqual) return;
  warnings.push_back(fmt::format(
      "{} bandwidth: {:.4g} MB/s measured, {:.4g} MB/s is the nearest that conventional PCI has",
      name, measured * 1e-6, modelled * 1e-6));
}

}  // namespace

double read_bandwidth(const link::Pci& pci) {
  return bandwidth(pci, pci.overhead_clocks + pci.read_wait_clocks);
}

double write_bandwidth(const link::Pci& pci) { return bandwidth(pci, pci.overhead_clocks); }

NearestPci nearest_pci(const link::Pci& base, const std::optional<Link>& read,
                       const std::optional<Link>& write) {
  NearestPci nearest{.pci = base, .read_deviation = {}, .write_deviation = {}, .warnings = {}};
  if (!read && !write) return nearest;
  std::vector<link::Pci> settings = all(base, read.has_value());
  settings.push_back(base);  // its burst may be no power of two
  double best = std::numeric_limits<double>::infinity();
  for (const link::Pci& pci : settings) best = std::min(best, deviation(pci, read, write));
  double least = std::numeric_limits<double>::infinity();
  for (const link::Pci& pci : settings) {
    const double changed = change(pci, base);
    if (changed >= least || deviation(pci, read, write) > best + kAsGood) continue;
    least = changed;
    nearest.pci = pci;
  }
  if (read) {
    set_latency("read", *read, nearest.pci.read_latency_s, nearest.warnings);
    nearest.read_deviation = read_bandwidth(nearest.pci) / read->bandwidth - 1;
    tell("read", read->bandwidth, read_bandwidth(nearest.pci), nearest.warnings);
  }
  if (write) {
    set_latency("write", *write, nearest.pci.write_latency_s, nearest.warnings);
    nearest.write_deviation = write_bandwidth(nearest.pci) / write->bandwidth - 1;
    tell("write", write->bandwidth, write_bandwidth(nearest.pci), nearest.warnings);
  }
  return nearest;
}

}  // namespace hvp::fit
