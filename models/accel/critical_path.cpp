#include "models/accel/critical_path.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "models/accel/engine_paths.h"
#include "models/config/input_error.h"

namespace hvp::accel {

namespace {

std::string nanoseconds(double seconds) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.2f ns", seconds * 1e9);
  return buffer;
}

constexpr double kClockStep = 1e4;  // Hz, of a clock that is sought

std::string megahertz(double hertz) {
  char buffer[32];
  // Down, so that what is told can be set.
  std::snprintf(buffer, sizeof buffer, "%.1f MHz", std::floor(hertz * 1e-5) / 10);
  return buffer;
}

std::string bits(int count, const char* what) { return std::to_string(count) + "-bit " + what; }

bool in_levels(ElementKind kind) {
  return kind == ElementKind::multiplexer || kind == ElementKind::shifter ||
         kind == ElementKind::gates || kind == ElementKind::absolute_value ||
         kind == ElementKind::comparator;
}

}  // namespace

double Path::delay_s() const {
  double sum = 0;
  for (const Element& element : elements) sum += element.delay_s;
  return sum;
}

std::string text(const Element& e) {
  switch (e.kind) {
    case ElementKind::clock_to_out:
      return "register";
    case ElementKind::set_up:
      return "set-up";
    case ElementKind::routing:
      return "routing";
    case ElementKind::multiplexer:
      return std::to_string(e.size) + "x1 multiplexer";
    case ElementKind::shifter:
      return bits(e.size, "shifter");
    case ElementKind::gates:
      return std::to_string(e.size) + "-input gates";
    case ElementKind::absolute_value:
      return bits(e.size, "absolute value");
    case ElementKind::adder:
      return bits(e.size, "adder");
    case ElementKind::comparator:
      return bits(e.size, "comparator");
    case ElementKind::multiplier:
      return bits(e.size, "multiplier");
    case ElementKind::multiplier_register:
      return "multiplier's register";
    case ElementKind::memory_read:
      return "memory without output register";
    case ElementKind::memory_register:
      return "memory's output register";
    case ElementKind::memory_set_up:
      return "memory's set-up";
    case ElementKind::block:
      return "the block's own limit";
  }
  return {};
}

std::string text(const Path& path) {
  std::string told;
  double nets = 0;
  Element now;  // levels of one element are told as one
  int levels = 0;
  const auto tell = [&told, &now, &levels] {
    if (levels == 0) return;
    told += told.empty() ? "" : ", ";
    // A comparator is a chain and a level of logic.
    if (now.kind == ElementKind::comparator && levels > 2) {
      told += std::to_string(levels / 2) + " times a ";
    }
    told += text(now) + " " + nanoseconds(now.delay_s);
  };
  for (const Element& element : path.elements) {
    if (element.kind == ElementKind::routing) {
      nets += element.delay_s;
    } else if (levels > 0 && in_levels(now.kind) && element.kind == now.kind &&
               element.size == now.size) {
      now.delay_s += element.delay_s;
      ++levels;
    } else {
      tell();
      now = element;
      levels = 1;
    }
  }
  tell();
  if (nets > 0) told += ", routing " + nanoseconds(nets);
  return told;
}

double highest_clock(const Clocking& c) {
  double period = 0;
  each_path(c, [&period](const Path& path) { period = std::max(period, path.period_s()); });
  return 1 / period;
}

double fastest_clock(const Clocking& c) {
  if (!c.device.timing) {
    throw InputError("clock", "the file of the " + c.device.name +
                                  " has no [timing], so that its fastest is not known: expected a "
                                  "frequency");
  }
  Architecture a = c.architecture;
  a.clock_hz = 0;
  double fastest = 0;
  // At a higher clock fewer memories are fast enough, and another one may be taken.
  constexpr int kMostSteps = 10;
  for (int step = 0; step < kMostSteps; ++step) {
    const double reached =
        std::floor(highest_clock({c.device, a, c.words, c.nodes}) / kClockStep) * kClockStep;
    if (!(reached > fastest)) break;
    a.clock_hz = fastest = reached;
  }
  return fastest;
}

CriticalPath critical_path(const Clocking& c) {
  CriticalPath result;
  each_path(c, [&result](const Path& path) { result.paths.push_back(path); });
  std::ranges::stable_sort(result.paths, std::ranges::greater{}, &Path::period_s);
  result.highest_clock_hz = 1 / result.paths.front().period_s();
  return result;
}

void require_clock(const Clocking& c) {
  if (!c.device.timing) return;
  const double wanted = c.architecture.clock_hz;
  if (wanted <= highest_clock(c)) return;
  const CriticalPath critical = critical_path(c);
  const Path& path = critical.paths.front();
  // Coarser steps could tell one number twice.
  char exact[32];
  std::snprintf(exact, sizeof exact, "%.7g MHz", wanted * 1e-6);
  char most[32];
  std::snprintf(most, sizeof most, "%.2f MHz",
                std::floor(critical.highest_clock_hz / kClockStep) / 100);
  const bool near = megahertz(wanted) == megahertz(critical.highest_clock_hz);
  throw InputError("clock", (near ? exact : megahertz(wanted)) + " is beyond what the " +
                                c.device.name + " reaches: expected at most " + most +
                                ", the limit of \"" + std::string(path.name) + "\": " + text(path) +
                                (path.transfers_per_clock > 1 ? ", twice a clock" : ""));
}

}  // namespace hvp::accel
