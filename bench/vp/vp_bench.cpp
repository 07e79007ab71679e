// The cost of the platform itself beside the arithmetic for which it waits: a frame in the ledger,
// and a transaction over the bus. SystemC elaborates once in a process, so that one bus serves all
// repetitions: the program's simulation runs inside the benchmark and goes on where it stopped.

#include <array>
#include <cstdint>
#include <cstring>
#include <systemc>

#include <benchmark/benchmark.h>
#include <tlm_utils/simple_target_socket.h>

#include "vp/frame/ledger.h"
#include "vp/frame/verdict.h"
#include "vp/host/board_access.h"
#include "vp/pci/pci_bus.h"

// SystemC's library has a main of its own, which calls this; neither is used.
int sc_main(int /*argc*/, char** /*argv*/) { return 1; }

namespace hvp::vp {
namespace {

// Opens, fills and closes frames of so many spans, verdict included.
void frames(benchmark::State& state) {
  Ledger ledger;
  Verdict verdict(2'000'000'000, 2'000'000'000);
  ledger.add_observer(verdict);
  std::int64_t number = 0;
  for (auto _ : state) {
    ledger.open(number, 0);
    Tag tag{number, kBirth};
    for (int span = 0; span < state.range(0); ++span) {
      ledger.extend(tag, Part::bus, Phase::bus_write, span * 1'000, span * 1'000 + 1'000);
    }
    ledger.force_at_motor(tag);
    ledger.close(number++);
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(frames)->Arg(20)->Arg(40)->Arg(160);

class Memory : public sc_core::sc_module {
 public:
  explicit Memory(const sc_core::sc_module_name& name) : sc_module(name), from_bus("from_bus") {
    from_bus.register_b_transport(this, &Memory::b_transport);
  }
  tlm_utils::simple_target_socket<Memory> from_bus;

 private:
  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& /*delay*/) {
    std::memcpy(transaction.get_data_ptr(), bytes_.data(), transaction.get_data_length());
    transaction.set_response_status(tlm::TLM_OK_RESPONSE);
  }
  std::array<unsigned char, 4096> bytes_{};
};

// Reads blocks for ever; each takes simulated time and two switches of the process.
class Reader : public sc_core::sc_module {
 public:
  Reader(const sc_core::sc_module_name& name, BoardAccess& access)
      : sc_module(name), access_(access) {
    SC_HAS_PROCESS(Reader);
    SC_THREAD(run);
  }
  std::size_t bytes = 4;
  std::int64_t done = 0;

 private:
  void run() {
    std::array<unsigned char, 4096> data{};
    for (;; ++done) access_.read(kSolverBase, data.data(), bytes);
  }
  BoardAccess& access_;
};

struct Bench {
  Bench() {
    access.to_bus.bind(bus.from_host);
    bus.attach(memory.from_bus, kSolverBase, 4096);
  }
  Ledger ledger;
  PciBus bus{"bus", link::Pci{}, false, ledger};
  Memory memory{"memory"};
  BoardAccess access{"access"};
  Reader reader{"reader", access};
};

void bus_reads(benchmark::State& state) {
  static Bench bench;
  bench.reader.bytes = static_cast<std::size_t>(state.range(0));
  const std::int64_t before = bench.reader.done;
  for (auto _ : state) sc_core::sc_start(100, sc_core::SC_US);
  state.counters["transactions"] = benchmark::Counter(
      static_cast<double>(bench.reader.done - before), benchmark::Counter::kIsRate);
}
BENCHMARK(bus_reads)->Arg(4)->Arg(3000);

}  // namespace
}  // namespace hvp::vp
