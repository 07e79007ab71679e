// The cost of an access over the socket of `hvp serve`, in wall time, from the C client.
#include <array>
#include <csignal>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/process/temporary_folder.h"
#include "driver/user/vfio_user_client.h"

namespace {

constexpr std::uint32_t kId = 0;
constexpr std::uint32_t kIterations = 0x44;
constexpr std::uint32_t kU = 0x40000;
constexpr std::size_t kWords = 750;  // U of 500 nodes, two elements a word

// A served board, from when it listens.
class Board {
 public:
  Board() {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) throw std::runtime_error("pipe failed");
    child_ = fork();
    if (child_ == 0) {
      dup2(ends[1], STDOUT_FILENO);
      close(ends[0]);
      close(ends[1]);
      execl(HVP_PROGRAM, HVP_PROGRAM, "serve", HVP_SCENARIO, "--vfio-user", socket().c_str(),
            nullptr);
      _exit(127);
    }
    close(ends[1]);
    char first = 0;
    const bool listens = read(ends[0], &first, 1) == 1;
    close(ends[0]);
    if (!listens || hvp_vfio_user_open(&client_, socket().c_str()) != 0) {
      throw std::runtime_error("hvp serve does not listen");
    }
  }
  ~Board() {
    hvp_vfio_user_close(&client_);
    kill(child_, SIGTERM);
    waitpid(child_, nullptr, 0);
  }
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;

  hvp_bus bus() { return hvp_vfio_user_bus(&client_); }

 private:
  std::string socket() const { return folder_.path() / "board"; }

  hvp::app::TemporaryFolder folder_{"hvp-bench"};
  pid_t child_ = -1;
  hvp_vfio_user client_{};
};

void register_read(benchmark::State& state) {
  Board board;
  const hvp_bus bus = board.bus();
  for (auto _ : state) benchmark::DoNotOptimize(bus.read32(bus.context, kId));
}
BENCHMARK(register_read)->Unit(benchmark::kMicrosecond)->UseRealTime();

// A write waits for nobody: with the read behind it for sixteen of them.
void register_writes(benchmark::State& state) {
  Board board;
  const hvp_bus bus = board.bus();
  for (auto _ : state) {
    for (int i = 0; i < 16; ++i) bus.write32(bus.context, kIterations, 60);
    benchmark::DoNotOptimize(bus.read32(bus.context, kId));
  }
}
BENCHMARK(register_writes)->Unit(benchmark::kMicrosecond)->UseRealTime();

void block_read(benchmark::State& state) {
  Board board;
  const hvp_bus bus = board.bus();
  std::vector<std::uint32_t> words(kWords);
  for (auto _ : state) bus.read_block(bus.context, kU, words.data(), words.size());
}
BENCHMARK(block_read)->Unit(benchmark::kMicrosecond)->UseRealTime();

}  // namespace
