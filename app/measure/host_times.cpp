#include "app/measure/host_times.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <functional>
#include <memory>
#include <numeric>
#include <string_view>
#include <thread>

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>

#include "models/fem/body.h"
#include "models/fem/structured_box.h"
#include "models/files/one_line.h"
#include "models/host/dense_solve.h"
#include "models/host/host_solve.h"

namespace hvp::app {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// What one call takes: the lower quartile of batches, since what other programs take is no part of
// it. A clock's own time is small beside a batch.
double typical_seconds(const std::function<void()>& call) {
  constexpr double kBatch = 50e-6;
  constexpr double kAltogether = 0.04;
  constexpr std::size_t kLeast = 7;
  call();
  const auto first = Clock::now();
  call();
  const int batch = std::max(1, static_cast<int>(kBatch / std::max(seconds_since(first), 1e-9)));
  std::vector<double> times;
  for (double spent = 0; spent < kAltogether || times.size() < kLeast;) {
    const auto start = Clock::now();
    for (int i = 0; i < batch; ++i) call();
    const double taken = seconds_since(start);
    spent += taken;
    times.push_back(taken / batch);
  }
  const auto quarter = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 4);
  std::nth_element(times.begin(), quarter, times.end());
  return *quarter;
}

// A cube of so many cells along each side that stands on its floor.
fem::Body cube(int cells) {
  std::vector<int> floor(static_cast<std::size_t>((cells + 1) * (cells + 1)));
  std::iota(floor.begin(), floor.end(), 0);
  return {fem::structured_box(Eigen::Vector3d::Constant(0.1), {cells, cells, cells}),
          fem::Material{}, floor, fem::AnchorTreatment::removed};
}

// The solvers of one body, ready to be timed.
class Timed {
 public:
  Timed(int cells, bool held_out) : body_(cube(cells)), held_out_(held_out) {
    const sparse::BlockMatrix& a = body_.stiffness();
    const std::vector<int> surface = host::touchable_nodes(body_);
    f_.resize(static_cast<std::size_t>(a.rows()));
    u_.resize(f_.size());
    for (std::size_t i = 0; i < f_.size(); ++i) f_[i] = 1e-3 * std::sin(static_cast<double>(i + 1));
    constexpr int kIterations = 60;
    add("cg", std::make_unique<host::ConjugateGradients<double>>(a, kIterations, 0, false));
    add("cholesky", std::make_unique<host::Prefactored>(a));
    for (const auto precision :
         {host::Precision::double_precision, host::Precision::single_precision}) {
      const bool single = precision == host::Precision::single_precision;
      for (const auto by :
           {host::SolvedBy::inverse, host::SolvedBy::condensed, host::SolvedBy::superposition}) {
        add(std::string(host::name(by)) + (single ? " single" : ""),
            host::make_dense_solve({by, precision, surface}, a));
      }
    }
    // A frame's load differs from the first one's on a facet.
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto node = static_cast<std::size_t>(surface[surface.size() / 2 + corner]);
      for (std::size_t i = 0; i < 3; ++i) f_[3 * node + i] *= 1.5;
    }
  }

  int unknowns() const { return body_.stiffness().rows(); }

  // Times each solver once more, and keeps the shorter time.
  void round() {
    for (Entry& entry : entries_) {
      host::HostSolve& solve = *entry.solve;
      const double seconds = typical_seconds([&] { solve.solve(f_, {}, u_); });
      entry.seconds = entry.seconds > 0 ? std::min(entry.seconds, seconds) : seconds;
    }
  }

  void take(std::vector<fit::SolveTime>& times) const {
    for (const Entry& entry : entries_) {
      times.push_back({entry.name, unknowns(), entry.solve->work() + entry.solve->rest_work(),
                       entry.solve->memory().working_set, entry.seconds, held_out_});
    }
  }

 private:
  struct Entry {
    std::string name;
    std::unique_ptr<host::HostSolve> solve;
    double seconds = 0;
  };

  void add(std::string name, std::unique_ptr<host::HostSolve> solve) {
    solve->move_contact({});
    solve->solve(f_, {}, u_);
    entries_.push_back({std::move(name), std::move(solve)});
  }

  fem::Body body_;
  bool held_out_;
  std::vector<double> f_, u_;
  std::vector<Entry> entries_;
};

// The data cache of this level that one processor sees, as Linux tells it; 0 where it does not. The
// C library's figure is of all caches of a package.
double cache_bytes(int level) {
  for (int index = 0; index < 8; ++index) {
    const std::string folder = fmt::format("/sys/devices/system/cpu/cpu0/cache/index{}/", index);
    int found = 0;
    std::string type;
    double size = 0;
    char unit = ' ';
    std::ifstream(folder + "level") >> found;
    std::ifstream(folder + "type") >> type;
    std::ifstream(folder + "size") >> size >> unit;
    if (found != level || type == "Instruction") continue;
    return size * (unit == 'K' ? 1024 : unit == 'M' ? 1024 * 1024 : 1);
  }
  return 0;
}

}  // namespace

host::Processor caches_of_this_machine() {
  host::Processor p = host::built_in(host::ProcessorModel::desktop_2026);
  for (std::size_t i = 0; i < p.caches.size(); ++i) {
    const double found = cache_bytes(static_cast<int>(i) + 1);
    if (found > 0) p.caches[i].size_bytes = found;
    if (i > 0) {
      p.caches[i].size_bytes = std::max(p.caches[i].size_bytes, p.caches[i - 1].size_bytes);
    }
  }
  return p;
}

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("model name")) continue;
    const auto begin = line.find(": ");
    return begin == std::string::npos ? std::string() : files::one_line(line.substr(begin + 2));
  }
  return {};
}

std::vector<fit::SolveTime> time_solves(const Progress& progress) {
  constexpr int kCells[] = {3, 5, 7, 9, 11};
  // In rounds over all of them: a machine that others use is faster and slower by turns.
  constexpr int kRounds = 5;
  std::vector<std::unique_ptr<Timed>> sizes;
  for (const int cells : kCells) {
    if (progress) progress(fmt::format("making solvers for cubes of {} cells a side", cells));
    sizes.push_back(std::make_unique<Timed>(cells, sizes.size() % 2 == 1));
  }
  for (int round = 1; round <= kRounds; ++round) {
    for (const auto& size : sizes) {
      if (progress) {
        progress(fmt::format("timing solves of {} unknowns, round {} of {}", size->unknowns(),
                             round, kRounds));
      }
      size->round();
    }
  }
  std::vector<fit::SolveTime> times;
  for (const auto& size : sizes) size->take(times);
  return times;
}

double WakeUps::longest_s() const {
  return counts.empty() ? 0 : static_cast<double>(counts.rbegin()->first) * 1e-7;
}

std::string WakeUps::csv() const {
  std::string text = "latency_us,count\n";
  for (const auto& [tenths, count] : counts) {
    text += fmt::format("{}.{},{}\n", tenths / 10, tenths % 10, count);
  }
  return text;
}

WakeUps time_wake_ups(double seconds, const Progress& progress) {
  constexpr std::int64_t kPeriod = 2'000'000;  // ns
  if (progress)
    progress(fmt::format("waiting for {:.0f} s of ticks with every core busy", seconds));
  std::atomic<bool> stop = false;
  std::vector<std::jthread> load;
  for (unsigned core = 0; core < std::max(1U, std::thread::hardware_concurrency()); ++core) {
    load.emplace_back([&stop] {
      // Reads and writes more than a cache of a core has room for, as a program that draws does.
      std::vector<double> field(1 << 18, 1.0);
      while (!stop.load(std::memory_order_relaxed)) {
        for (double& x : field) x = 0.5 * x + 1;
      }
    });
  }
  WakeUps found;
  std::jthread([&] {
    sched_param priority{};
    priority.sched_priority = 80;
    found.real_time = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &priority) == 0;
    timespec next{};
    ::clock_gettime(CLOCK_MONOTONIC, &next);
    const auto ticks = static_cast<std::int64_t>(seconds * 1e9 / kPeriod);
    for (std::int64_t tick = 0; tick < ticks; ++tick) {
      next.tv_nsec += kPeriod;
      if (next.tv_nsec >= 1'000'000'000) {
        next.tv_nsec -= 1'000'000'000;
        ++next.tv_sec;
      }
      ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, nullptr);
      timespec now{};
      ::clock_gettime(CLOCK_MONOTONIC, &now);
      const std::int64_t late =
          (now.tv_sec - next.tv_sec) * 1'000'000'000LL + (now.tv_nsec - next.tv_nsec);
      ++found.counts[std::max<std::int64_t>(0, (late + 50) / 100)];
      ++found.ticks;
      // What passed meanwhile is a skipped tick, and no further lateness.
      while (late > kPeriod &&
             (now.tv_sec - next.tv_sec) * 1'000'000'000LL + (now.tv_nsec - next.tv_nsec) >
                 kPeriod) {
        next.tv_nsec += kPeriod;
        if (next.tv_nsec >= 1'000'000'000) {
          next.tv_nsec -= 1'000'000'000;
          ++next.tv_sec;
        }
      }
    }
  }).join();
  stop = true;
  return found;
}

}  // namespace hvp::app
