#pragma once

#include <array>
#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/board/hvp_board.h"

// A program with the board in its own process, on a board that fails in one of its jobs.
namespace hvp::test {

inline constexpr const char* kScenario = HVP_SCENARIOS "/thesis-static.toml";
inline constexpr std::uint64_t kLongestWait = 20'000'000;  // ns
inline constexpr int kFaultyJob = 2;
inline constexpr int kJobs = 6;
inline constexpr std::size_t kUnknowns = 6;

inline constexpr std::array<std::int32_t, 3> kRowBegin = {0, 1, 2};
inline constexpr std::array<std::int32_t, 2> kColumn = {0, 1};
inline constexpr std::array<std::int32_t, 18> kValue = {64, 0, 0, 0, 32, 0, 0, 0, 16,
                                                        64, 0, 0, 0, 32, 0, 0, 0, 16};

struct FaultCase {
  std::string name;
  std::vector<const char*> keys = {};
  // Where the board can do it.
  bool with_blocks = true;
  bool with_dma = true;
  bool with_polling = true;
  bool with_pci = true;
  bool with_dma_messages = true;  // else with DMA only where the host hears by the line
};

inline std::vector<FaultCase> fault_cases() {
  constexpr const char* kAbort = "fault[0].kind=master-abort";
  constexpr const char* kPoisoned = "fault[0].kind=aer-uncorrectable";
  constexpr const char* kCorrupted = "fault[0].kind=corrupted-word";
  return {
      {.name = "none"},
      {.name = "lost_interrupt", .keys = {"fault[0].kind=lost-interrupt"}, .with_polling = false},
      {.name = "stuck_busy", .keys = {"fault[0].kind=stuck-busy"}},
      {.name = "abort_rhs", .keys = {kAbort, "fault[0].access=rhs"}, .with_dma = false},
      {.name = "abort_start", .keys = {kAbort, "fault[0].access=start"}},
      {.name = "abort_status",
       .keys = {kAbort, "fault[0].access=status"},
       .with_polling = false,
       .with_dma_messages = false},
      {.name = "abort_acknowledge",
       .keys = {kAbort, "fault[0].access=acknowledge"},
       .with_dma_messages = false},
      {.name = "abort_solution", .keys = {kAbort, "fault[0].access=solution"}, .with_dma = false},
      {.name = "corrupted_rhs", .keys = {kCorrupted, "fault[0].access=rhs"}, .with_dma = false},
      {.name = "corrupted_solution",
       .keys = {kCorrupted, "fault[0].access=solution"},
       .with_dma = false},
      {.name = "device_gone", .keys = {"fault[0].kind=device-gone", "fault[0].frames=3"}},
      {.name = "aer_correctable",
       .keys = {"fault[0].kind=aer-correctable", "fault[0].access=start"},
       .with_pci = false},
      {.name = "aer_rhs",
       .keys = {kPoisoned, "fault[0].access=rhs"},
       .with_dma = false,
       .with_pci = false},
      {.name = "aer_start", .keys = {kPoisoned, "fault[0].access=start"}, .with_pci = false},
      {.name = "aer_acknowledge",
       .keys = {kPoisoned, "fault[0].access=acknowledge"},
       .with_pci = false,
       .with_dma_messages = false},
      {.name = "reset_by_somebody_else", .keys = {"fault[0].kind=function-level-reset"}},
      {.name = "late_dma",
       .keys = {"fault[0].kind=late-dma", "fault[0].delay=3 ms"},
       .with_blocks = false},
      {.name = "late_dma_beyond_the_wait",
       .keys = {"fault[0].kind=late-dma", "fault[0].delay=30 ms"},
       .with_blocks = false},
      {.name = "truncated_dma",
       .keys = {"fault[0].kind=truncated-dma", "fault[0].bytes=8"},
       .with_blocks = false}};
}

struct Parameters {
  FaultCase fault;
  bool dma = false;
  std::string notification;
  bool pcie = false;
};

inline std::vector<Parameters> all_parameters() {
  std::vector<Parameters> all;
  for (const FaultCase& fault : fault_cases()) {
    for (const bool dma : {false, true}) {
      for (const char* const notification : {"intx", "msi", "polling"}) {
        for (const bool pcie : {false, true}) {
          const std::string heard = notification;
          const bool possible = (dma ? fault.with_dma : fault.with_blocks) &&
                                (heard != "polling" || fault.with_polling) &&
                                (!dma || heard == "intx" || fault.with_dma_messages);
          if (possible && (pcie || fault.with_pci)) all.push_back({fault, dma, heard, pcie});
        }
      }
    }
  }
  return all;
}

inline std::string name_of(const testing::TestParamInfo<Parameters>& test) {
  const Parameters& p = test.param;
  return p.fault.name + (p.dma ? "_dma_" : "_blocks_") + p.notification +
         (p.pcie ? "_pcie" : "_pci");
}

// The name as ctest prints it beside the case's.
inline void PrintTo(const Parameters& parameters,
                    std::ostream* out) {  // NOLINT(readability-identifier-naming)
  *out << parameters.fault.name;
}

// What a user's program has: a driver's handle, memory, and its own clock.
class Program {
 public:
  explicit Program(const Parameters& parameters, const std::vector<const char*>& more = {})
      : dma_(parameters.dma) {
    std::vector<const char*> keys = parameters.fault.keys;
    const std::string frame = "fault[0].frame=" + std::to_string(kFaultyJob);
    if (!keys.empty()) keys.push_back(frame.c_str());
    const std::string notify = "transfer.notification=" + parameters.notification;
    keys.push_back(notify.c_str());
    const char* const blocks =
        parameters.pcie ? "transfer.method=programmed-io" : "transfer.method=bursts";
    keys.push_back(dma_ ? "transfer.method=dma" : blocks);
    if (parameters.pcie) keys.push_back("bus.pcie.generation=gen3");
    if (!parameters.fault.with_pci) keys.push_back("function.pci_express=true");
    keys.insert(keys.end(), more.begin(), more.end());
    const hvp_board_options options = {keys.data(), keys.size(), nullptr, false, nullptr};
    board = hvp_board_open(kScenario, &options, why.data(), why.size());
    if (board == nullptr) return;
    hvp_board_map(board, kAddress, memory_.data(), sizeof memory_);
  }
  ~Program() { hvp_board_close(board); }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  hvp_status open() {
    hvp_status status = hvp_open(&device, hvp_board_bus(board), scratch_.data(), scratch_.size());
    const hvp_dma dma = {.to_board = &to_board_,
                         .to_board_count = 1,
                         .to_host = &to_host_,
                         .to_host_count = 1,
                         .list = memory_.data(),
                         .list_address = kAddress,
                         .record = memory_.data() + 32,
                         .record_address = kAddress + 128,
                         .values = nullptr,
                         .values_count = 0,
                         .values_list = nullptr,
                         .values_list_address = 0,
                         .context = nullptr,
                         .sync = nullptr};
    if (status == HVP_OK && dma_) status = hvp_use_dma(&device, &dma);
    return status == HVP_OK ? load() : status;
  }
  // A board that is gone is asked again until it is back.
  bool recover() {
    constexpr int kTries = 100'000;
    for (int i = 0; i < kTries; ++i) {
      if (hvp_reset(&device) == HVP_OK && load() == HVP_OK) return true;
    }
    return false;
  }
  hvp_status load() {
    hvp_solver_config config{};
    config.method = HVP_METHOD_JACOBI_PCG;
    config.iterations = 4;
    config.matrix_bits = 12;
    config.vector_bits = 16;
    config.coefficient_bits = 16;
    config.dynamic_scaling = true;
    const hvp_status status = hvp_configure(&device, &config);
    const hvp_matrix k = {2, 2, kRowBegin.data(), kColumn.data(), kValue.data()};
    return status == HVP_OK ? hvp_load_matrix(&device, &k) : status;
  }

  std::array<char, 256> why{};
  hvp_board* board = nullptr;
  hvp_device device{};

 private:
  static constexpr std::uint64_t kAddress = 0x1000'0000;

  bool dma_;
  alignas(64) std::array<std::uint32_t, 256> memory_{};
  std::array<std::uint32_t, 64> scratch_{};
  hvp_segment to_board_{memory_.data() + 64, kAddress + 256, 64};
  hvp_segment to_host_{memory_.data() + 128, kAddress + 512, 64};
};

}  // namespace hvp::test
