#include "models/host/costs.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "models/config/effects.h"
#include "models/config/input_error.h"
#include "models/time/picoseconds.h"

namespace hvp::host {

namespace {
constexpr int kLongestBackOff = 1 << 20;  // frames

std::vector<std::pair<std::string_view, Guard>> guard_names() {
  return {{"with-faults", Guard::with_faults}, {"always", Guard::always}, {"never", Guard::never}};
}
}  // namespace

void Recovery::declare(config::Visitor& v) {
  v.choice("bus_errors", bus_errors, guard_names(),
           {"whether the driver asks the bridge, twice a frame, for aborted accesses and damaged "
            "words; with-faults: where the scenario has [[fault]]",
            "a frame without faults is the thesis'"});
  v.choice("hold_saturated", hold_saturated, guard_names(),
           {"whether the force of a solve that saturated is held back and the last one kept",
            "a frame without faults is the thesis'"});
  v.integer("retries", retries, {0, 16},
            {"how often a frame repeats an access to STATUS or U that failed, while there is time",
             "assumed: what is wrong twice will stay so"});
  v.integer("attempts", attempts, {1, 64},
            {"set-ups of the board in a row that may fail before it is given up", "assumed"});
  v.integer("back_off", back_off_frames, {1, 10'000},
            {"frames between the first set-up that fails and the next; doubled each time",
             "assumed: with 8 attempts a quarter of a second at 500 Hz"});
}

int Recovery::back_off(int failed) const {
  std::int64_t frames = back_off_frames;
  for (int i = 1; i < failed && frames < kLongestBackOff; ++i) frames *= 2;
  return static_cast<int>(std::min<std::int64_t>(frames, kLongestBackOff));
}

using config::Dimension;

void Graphics::declare(config::Visitor& v, int cores) {
  v.quantity("rate", rate_hz, Dimension::frequency, config::between(1, 2000),
             {"rate of the collision and graphics process", "thesis section 6.2.3"});
  v.quantity("drawing_time", drawing_s, Dimension::time, config::between(0, 1),
             {"time of a pass that is not collision detection: one picture",
              "assumed: a third of the period"});
  v.quantity("triangle_time", triangle_s, Dimension::time, config::between(0, 1e-3),
             {"what each triangle of the surface adds to drawing_time",
              "none: drawing_time holds for every mesh"});
  v.when({"host.cores", {"1"}, std::to_string(cores)}, [&] {
    v.quantity("non_preemptible", non_preemptible_s, Dimension::time, config::between(0, 0.1),
               {"how long a section is that holds the servo process up",
                "none: every instruction can be preempted"});
    v.quantity("non_preemptible_every", non_preemptible_every_s, Dimension::time,
               config::between(1e-6, 1),
               {"processor time from one such section's beginning to the next one's",
                "assumed: a call of the graphics driver every millisecond"});
  });
}

void Graphics::check() const {
  if (non_preemptible_s <= non_preemptible_every_s) return;
  throw InputError("non_preemptible",
                   fmt::format("expected at most non_preemptible_every = {:g} us, found {:g} us",
                               1e6 * non_preemptible_every_s, 1e6 * non_preemptible_s));
}

std::int64_t Graphics::period_ps() const { return to_period(rate_hz); }

std::int64_t Graphics::drawing_ps(std::size_t triangles) const {
  return to_picoseconds(drawing_s + static_cast<double>(triangles) * triangle_s);
}

InterruptLatencies::InterruptLatencies() {
  mean_s = 3e-6;
  minimum_s = 2e-6;
}

void InterruptLatencies::declare(config::Visitor& v) {
  TimeDistribution::declare(
      v, {.kind = "assumed: no figure published for QuaRC; many short delays, few long ones",
          .mean = "assumed: with minimum it makes the mean that of interrupt_latency's default",
          .minimum = "assumed; real-time extensions lie between 2 and 20 us"});
}

void Delay::declare(config::Visitor& v) {
  v.quantity(
      "time", time_s, Dimension::time, config::between(0, 1),
      {"by how much each force comes later",
       "half the thesis' period: a held force is half a period old already, so that this "
       "halves the stiffest wall a loop can hold (Colgate & Schenkel 1997: b > K (T/2 + L))"});
}

void Host::declare(config::Visitor& v, const config::Condition& body) {
  const auto of_model = v.variant(
      "model", model,
      {{name(ProcessorModel::one_rate), ProcessorModel::one_rate},
       {name(ProcessorModel::thesis_pc), ProcessorModel::thesis_pc},
       {name(ProcessorModel::desktop_2026), ProcessorModel::desktop_2026},
       {name(ProcessorModel::measured), ProcessorModel::measured}},
      {"what the host's work costs: all of it at one rate, or by its kind and by the memory that "
       "holds it, for the thesis' PC, a present one, or one that `hvp measure host` has measured",
       "thesis section 6.2.1 counts operations"});
  of_model.only({ProcessorModel::one_rate}, [&] {
    v.quantity("sustained_rate", sustained_rate_flops, Dimension::throughput,
               config::between(1e6, 1e12),
               {"operations a second in sparse products",
                "thesis Table 6.3: Netburst at 2.8 GHz, the host's family"});
  });
  of_model.only({ProcessorModel::measured}, [&] {
    v.table("processor", processor, {"what a core of the host does in a second"});
  });
  v.quantity(
      "contact_lookup", contact_lookup_s, Dimension::time, config::between(0, 1e-3),
      {"fetching the contact node from the collision process", "assumed: a lock and a copy"});
  v.quantity("driver_call", driver_call_s, Dimension::time, config::between(0, 1e-3),
             {"instructions of a driver call beside its bus accesses", "assumed"});
  v.quantity("driver_word", driver_word_s, Dimension::time, config::between(0, 1e-6),
             {"of a driver call, for each vector word that it packs or unpacks",
              "0: it is in driver_call; measured 0.8 ns to pack, 0.3 ns to unpack, Xeon 2.6 GHz"});
  v.quantity("interrupt_latency", interrupt_latency_s, Dimension::time, config::between(0, 1e-2),
             {"from the board's interrupt until the servo process runs again",
              "assumed; real-time extensions lie between 2 and 20 us"});
  v.quantity("timeout", timeout_s, Dimension::time, config::between(1e-6, 10),
             {"how long the driver waits for the board", "five periods at 500 Hz"});
  v.when(body, [&] {
    const auto of_solver = v.variant(
        "solver", solver,
        {{"board", SolvedBy::board},
         {"cg", SolvedBy::cg},
         {"cholesky", SolvedBy::cholesky},
         {"inverse", SolvedBy::inverse},
         {"superposition", SolvedBy::superposition},
         {"condensed", SolvedBy::condensed},
         {"explicit", SolvedBy::steps}},
        {"board: the FPGA; the others have no board: cg; cholesky: factors of A; inverse: A's "
         "inverse; superposition: its columns where contact can be; condensed: the inverse there, "
         "factors for the rest after the force; explicit: nothing is solved, the host moves the "
         "body by explicit time steps",
         "thesis section 6.2.1"});
    of_solver.only(
        {SolvedBy::cg, SolvedBy::inverse, SolvedBy::superposition, SolvedBy::condensed}, [&] {
          v.choice(
              "precision", precision,
              {{"double", Precision::double_precision}, {"single", Precision::single_precision}},
              {"of cg's matrix and vectors, or of the inverse and its products",
               "as everything else on the host"});
        });
    of_solver.only({SolvedBy::cg, SolvedBy::cholesky, SolvedBy::inverse, SolvedBy::superposition,
                    SolvedBy::condensed, SolvedBy::steps},
                   [&] {
                     of_model.only({ProcessorModel::one_rate}, [&] {
                       v.quantity("solver_rate", solver_rate_flops, Dimension::throughput,
                                  config::between(0, 1e13),
                                  {"operations a second of the host's own solve; 0: sustained_rate",
                                   "absent: Table 6.3's rate is that of sparse products"});
                     });
                   });
    of_solver.only({SolvedBy::steps}, [&] {
      v.integer("substeps", substeps, {0, 100'000},
                {"explicit time steps a frame; 0: as many as take 0.8 of the longest stable one at "
                 "rest",
                 "0: a deformed body is stable for less, docs/tissue.md"});
    });
  });
  v.integer("pipeline_depth", pipeline_depth, {0, 1},
            {"1: the force comes a period later, and the board solves meanwhile",
             "thesis Fig. 6.2: one frame after the other"});
  v.quantity(
      "quantum", quantum_s, Dimension::time, config::between(0, 1),
      {"temporal decoupling of the servo process, for speed: the results do not depend on it",
       "docs/virtual-platform.md; 0: every step synchronises"});
  v.integer("cores", cores, {1, 2},
            {"2: a core for each process; 1: the servo process preempts the other one",
             "thesis section 6.2: a Pentium D, which has two"});
  v.when({"cores", {"1"}, std::to_string(cores)}, [&] {
    v.quantity("context_switch", context_switch_s, Dimension::time, config::between(0, 1e-3),
               {"from one process to the other",
                "Li, Ding & Shen, ExpCS 2007: 3.8 us without cold caches, dual 2 GHz Xeon; from "
                "memory, unverified"});
  });
  v.effect("jitter", jitter,
           {"the timer releases the servo process late, by a time drawn for each tick",
            random::drawn("before each frame: the timer is late", jitter),
            {config::need_timed_host()}});
  v.effect("wake_up", wake_up,
           {"the servo process runs some time after its tick or interrupt has made it ready, drawn "
            "each time",
            random::drawn("after each tick and interrupt: until the process runs", wake_up),
            {config::need_timed_host()}});
  v.effect("interrupt_latencies", interrupt_latencies,
           {"interrupt_latency drawn for each interrupt of a frame; set-up has the constant",
            random::drawn("in the place of host.interrupt_latency, at each interrupt",
                          interrupt_latencies),
            {config::need_timed_host(),
             config::need_board("no board interrupts"),
             {"transfer.notification", {"intx", "msi"}, "nothing interrupts"}}});
  v.when(body, [&] {
    v.effect("gpu", gpu,
             {"the host's own solve is made by a GPU, in host.precision",
              random::drawn("no module: what the solve takes",
                            gpu ? gpu->latencies : std::optional<GpuLatencies>()),
              Gpu::needs()});
  });
  v.when(body, [&] {
    v.effect("threads", threads,
             {"the host's own solver works with several threads, each on a core of its own",
              "no module: what a solve takes",
              {config::need_timed_host(),
               {"host.solver",
                {"cg", "inverse", "superposition"},
                "products with a matrix or an inverse alone are divided among threads"}}});
  });
  v.effect("delay", delay,
           {"every force is at the motor so much later, with nothing else changed: what if the "
            "latency were longer?",
            "no module: a force is told to the device for a later time"});
  v.effect("virtual_coupling", virtual_coupling,
           {"a spring and a damper between the position that was read and the tool that body or "
            "wall see",
            "no module: the tool's place, 24 operations a probe and frame, 32 before a wall, in "
            "the step `hold`"});
  v.effect("passivity", passivity,
           {"the host counts the energy at the device's port, and damps where the loop has given "
            "more than it got",
            "no module: 10 operations a probe and frame, 19 more where it damps, in the step "
            "`force`"});
  v.when(body, [&] {
    v.table("graphics", graphics, {"the 33 Hz collision and graphics process"}, cores);
    v.table("recovery", recovery, {"what the servo process does about a board that fails"});
  });
}

void Host::check() const {
  constexpr double kLeastRate = 1e6;
  if (solver_rate_flops > 0 && solver_rate_flops < kLeastRate) {
    throw InputError(
        "solver_rate",
        fmt::format("expected 0, or at least 1 Mflop/s, found {:g} flop/s", solver_rate_flops));
  }
  if (threads && gpu)
    throw InputError("threads", "the GPU solves: expected none beside [host.gpu]");
  if (threads && threads->count >= threads->cores && cores != 1) {
    throw InputError("cores", fmt::format("{} threads on {} cores leave the collision process none "
                                          "of its own: expected 1, found {}",
                                          threads->count, threads->cores, cores));
  }
  if (pipeline_depth > 0 && solver != SolvedBy::board) {
    throw InputError("pipeline_depth",
                     "expected 0: without a board nothing solves while the host does other work");
  }
}

void Threads::declare(config::Visitor& v) {
  v.integer("count", count, {2, 256}, {"threads that solve", "the fewest that are several"});
  v.quantity("speedup", speedup, Dimension::dimensionless, config::between(1, 256),
             {"how many times as fast as one thread they are, their waits for each other apart",
              "1: it hangs on solver, size and memory; measure yours"});
  v.quantity("barrier", barrier_s, Dimension::time, config::between(0, 1e-3),
             {"until all of them have seen that all are there",
              "measured: 0.25 us, two processors of an AMD EPYC that spin"});
  v.integer("cores", cores, {2, 1024},
            {"of the machine: where the threads take all, the collision process has none of its "
             "own, and host.cores is 1",
             "assumed: as a desktop PC has at least"});
}

void Threads::check() const {
  if (count > cores) {
    throw InputError("count", fmt::format("expected at most cores = {}, found {}", cores, count));
  }
  if (speedup > count) {
    throw InputError("speedup",
                     fmt::format("expected at most count = {}, found {:g}", count, speedup));
  }
}

double Threads::seconds(double one_thread_s, const SolveWork& work) const {
  return one_thread_s / speedup + barrier_s * std::max({work.calls, work.barriers, 1});
}

SharedCore::Settings Host::shared_core() const {
  return {to_picoseconds(context_switch_s), to_picoseconds(graphics.non_preemptible_s),
          to_picoseconds(graphics.non_preemptible_every_s)};
}

double Host::driver_s(std::size_t words) const {
  return driver_call_s + driver_word_s * static_cast<double>(words);
}

const Processor* Host::prices() const {
  switch (model) {
    case ProcessorModel::one_rate:
      return nullptr;
    case ProcessorModel::measured:
      return &processor;
    case ProcessorModel::thesis_pc:
    case ProcessorModel::desktop_2026:
      break;
  }
  return &built_in(model);
}

double Host::rate_flops() const {
  const Processor* priced = prices();
  return priced == nullptr ? sustained_rate_flops : priced->sparse_flops;
}

std::int64_t Host::compute_ps(double operations) const {
  return to_picoseconds(operations / rate_flops());
}

double Host::solve_s(const SolveWork& work, const SolveMemory& memory) const {
  return gpu ? gpu->seconds(work, memory) : core_solve_s(work, memory.working_set);
}

double Host::core_solve_s(const SolveWork& work, double working_set) const {
  const Processor* priced = prices();
  const double one_thread_s =
      priced != nullptr
          ? priced->seconds(work, working_set)
          : work.operations() / (solver_rate_flops > 0 ? solver_rate_flops : sustained_rate_flops);
  if (!threads || !(work.operations() > 0)) return one_thread_s;
  return threads->seconds(one_thread_s, work);
}

double conversion_operations(int words) { return 4.0 * words; }

void GuestCosts::declare(config::Visitor& v) {
  v.quantity("system_call", system_call_s, config::Dimension::time,
             config::between(0, kLongestSystemCall),
             {"from a program's system call until the kernel begins to do it, with `hvp linux`",
              "measured: getppid() takes 0.17 us, Linux 6.18 on an AMD EPYC, whose kernel needs no "
              "page tables of its own"});
  const auto of_schedule = v.variant(
      "schedule", schedule, {{"immediate", Schedule::immediate}, {"random", Schedule::random}},
      {"random: behind one access to the board in eight, and before one interrupt in eight, the "
       "host stands still for a time that `seed` draws",
       "a program that runs alone"});
  of_schedule.only({Schedule::random}, [&] {
    v.quantity("longest_delay", longest_delay_s, config::Dimension::time,
               config::between(1e-6, 0.1),
               {"the longest of these times; their logarithms are uniform from 100 ns on",
                "assumed: half a period at 500 Hz"});
  });
  v.choice("memory_order", memory_order,
           {{"strong", MemoryOrder::strong}, {"weak", MemoryOrder::weak}},
           {"weak: what the host has stored since its last barrier, the board may see late, a line "
            "of 64 bytes at a time, as `seed` draws it; a register access is no barrier",
            "x86 keeps the order of its stores (Intel SDM volume 3, 9.2.2)"});
}

}  // namespace hvp::host
