// The cost of a Linux kernel on simulated time, in wall time, as whole runs of `hvp linux`: from
// the start until the kernel has booted, loaded the module, solved some frames of the thesis and
// switched off. One frame: the way to a first job. 501: a second of servo frames at 500 Hz more.
// Watched: with `--check driver,dma`.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "app/process/temporary_folder.h"

namespace {

namespace fs = std::filesystem;

void run(const std::string& words) {
  const std::string command = fmt::format("'{}' {} >/dev/null 2>&1", HVP_PROGRAM, words);
  if (std::system(command.c_str()) != 0) throw std::runtime_error("failed: " + command);
}

void frames_with(benchmark::State& state, const std::string& more) {
  const hvp::app::TemporaryFolder folder("hvp-bench");
  const std::string here = folder.path().string();
  try {
    run(
        fmt::format("run '{}' --record-jobs --quiet --set frames={} --set output.pictures=false "
                    "--set reference=false --out '{}/run'",
                    HVP_SCENARIO, state.range(0), here));
    std::ofstream(folder.path() / "script")
        << fmt::format("hvp-servo /dev/hvp0 /host{0}/run/jobs.hvpf /host{0}/u\n", here);
    const std::string words = fmt::format(
        "linux '{}' --quiet --set transfer.method=dma --set transfer.notification=msi "
        "--script '{}/script' --out '{}/out' {}",
        HVP_SCENARIO, here, here, more);
    for (auto _ : state) run(words);
  } catch (const std::exception& error) {
    state.SkipWithError(error.what());
  }
}
void frames(benchmark::State& state) { frames_with(state, ""); }
void frames_watched(benchmark::State& state) { frames_with(state, "--check driver,dma"); }
BENCHMARK(frames_watched)->Arg(501)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(frames)->Arg(1)->Arg(501)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
