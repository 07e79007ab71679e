#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "app/board/hvp_board.h"
#include "vp/fpga/register_bank.h"
#include "vp/function/driver_finding.h"

// A driver written from the register map alone, for drivers with a mistake and those without one.
namespace hvp::test::registers {

inline constexpr const char* kScenario = HVP_SCENARIOS "/thesis-static.toml";
inline constexpr std::uint64_t kAddress = 0x1000'0000;
inline constexpr std::size_t kPage = 4096;
namespace field = hvp::vp::field;
using hvp::vp::Aperture;
using hvp::vp::offset_of;
using hvp::vp::Register;
inline constexpr std::uint32_t kBlocks = offset_of(Register::blocks);
inline constexpr std::uint32_t kControl = offset_of(Register::control);
inline constexpr std::uint32_t kDmaCount = offset_of(Register::dma_count);
inline constexpr std::uint32_t kDmaListLow = offset_of(Register::dma_list_low);
inline constexpr std::uint32_t kDmaRecordLow = offset_of(Register::dma_record_low);
inline constexpr std::uint32_t kDmaValuesCount = offset_of(Register::dma_values_count);
inline constexpr std::uint32_t kDmaValuesLow = offset_of(Register::dma_values_low);
inline constexpr std::uint32_t kFormat = offset_of(Register::format);
inline constexpr std::uint32_t kInterruptEnable = offset_of(Register::interrupt_enable);
inline constexpr std::uint32_t kInterruptStatus = offset_of(Register::interrupt_status);
inline constexpr std::uint32_t kIterations = offset_of(Register::iterations);
inline constexpr std::uint32_t kNodes = offset_of(Register::nodes);
inline constexpr std::uint32_t kStatus = offset_of(Register::status);
inline constexpr std::uint32_t kBMemory = offset_of(Aperture::b);
inline constexpr std::uint32_t kColumnMemory = offset_of(Aperture::column);
inline constexpr std::uint32_t kRowBeginMemory = offset_of(Aperture::row_begin);
inline constexpr std::uint32_t kUMemory = offset_of(Aperture::u);
inline constexpr std::uint32_t kValueMemory = offset_of(Aperture::value);
inline constexpr std::uint64_t kSecond = 1'000'000'000;  // ns

// The matrix of one node, diag(4, 2, 1) times 16 in words of 16 bits.
inline constexpr std::array<std::uint32_t, 5> kValues = {64, 0, 32, 0, 16};

// A driver of the register map alone, of a board with one node.
class Driver {
 public:
  static constexpr std::size_t kPages = 6;
  explicit Driver(std::vector<const char*> keys, bool check = true) {
    const hvp_board_options options = {keys.data(), keys.size(), nullptr, check, nullptr};
    std::array<char, 256> why{};
    board = hvp_board_open(kScenario, &options, why.data(), why.size());
    if (board == nullptr) throw std::runtime_error(why.data());
    maps = hvp_board_map(board, kAddress, memory.data(), sizeof memory);
  }
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;
  ~Driver() { hvp_board_close(board); }

  void write(std::uint32_t offset, std::uint32_t value) {
    ++accesses;
    hvp_board_write(board, offset, &value, sizeof value);
  }
  std::uint32_t read(std::uint32_t offset) {
    ++accesses;
    std::uint32_t value = 0;
    hvp_board_read(board, offset, &value, sizeof value);
    return value;
  }
  // The access at which the mistake is made.
  void mistake() { at = accesses + 1; }

  void load() {
    write(kNodes, 1);
    write(kBlocks, 1);
    write(kIterations, 4);
    fill();
  }
  void fill() {
    write(kRowBeginMemory, 0);
    write(kRowBeginMemory + 4, 1);
    write(kColumnMemory, 0);
    for (std::size_t i = 0; i < kValues.size(); ++i) {
      write(static_cast<std::uint32_t>(kValueMemory + 4 * i), kValues[i]);
    }
    write(kControl, field::kControlLoadDone.mask());
    wait();
    acknowledge();
  }
  void give_b() {
    write(kBMemory, 640U | 640U << 16);
    write(kBMemory + 4, 640);
  }
  void start() { write(kControl, field::kControlStart.mask()); }
  void wait() {
    while ((read(kStatus) & field::kStatusBusy.mask()) != 0) {
      hvp_board_run_until_ps(board, hvp_board_now_ps(board) + 1'000'000);
    }
  }
  void acknowledge() { write(kInterruptStatus, field::kInterruptStatusDone.mask()); }
  void solve() {
    give_b();
    start();
    wait();
    acknowledge();
    read(kUMemory);
  }

  std::uint32_t* page(std::size_t i) { return memory.data() + i * kPage / 4; }
  static std::uint32_t address(std::size_t i) {
    return static_cast<std::uint32_t>(kAddress + i * kPage);
  }
  // Two descriptors, for b and U, in page 2; b in page 0, U in page 1, the record in page 3.
  void describe(std::uint32_t bytes = 8, std::uint32_t b = address(0)) {
    const std::array<std::uint32_t, 16> list = {0, bytes, b,          0, kBMemory, 0, 0, 0,
                                                1, 8,     address(1), 0, kUMemory, 0, 0, 0};
    std::ranges::copy(list, page(2));
    page(0)[0] = 640U | 640U << 16;
    page(0)[1] = 640;
  }
  // Lists and b are the board's from here on.
  void barrier() { hvp_board_barrier(board); }
  void tell_list() {
    write(kDmaListLow, address(2));
    write(kDmaCount, 1U | 1U << 16);
    write(kDmaRecordLow, address(3));
  }
  void ring() {
    page(3)[0] = 0;
    barrier();
    start_list();
  }
  void start_list() { write(kControl, field::kControlRunList.mask()); }
  // True if the record came within a millisecond.
  bool await_record() {
    const std::uint64_t late = hvp_board_now_ps(board) + 1'000'000'000;
    while (page(3)[0] == 0 && hvp_board_now_ps(board) < late) {
      hvp_board_run_until_ps(board, hvp_board_now_ps(board) + 1'000'000);
    }
    return page(3)[0] != 0;
  }
  void solve_by_dma() {
    describe();
    tell_list();
    ring();
    await_record();
    acknowledge();
  }

  // The values, in page 4, and in page 5 their descriptor.
  void describe_values() {
    std::ranges::copy(kValues, page(4));
    const std::array<std::uint32_t, 8> one = {0, 4 * kValues.size(), address(4), 0, kValueMemory};
    std::ranges::copy(one, page(5));
  }
  void tell_values() {
    write(kDmaValuesLow, address(5));
    write(kDmaValuesCount, 1);
  }
  void fetch_values() {
    barrier();
    write(kControl, field::kControlFetchValues.mask());
  }
  void renew_by_dma() {
    describe_values();
    tell_values();
    fetch_values();
    wait();
    acknowledge();
  }

  std::vector<hvp_board_finding> findings() {
    std::array<hvp_board_finding, hvp::vp::kDriverRules> all{};
    const std::size_t count = hvp_board_findings(board, all.data(), all.size());
    return {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count)};
  }

  hvp_board* board = nullptr;
  bool maps = false;
  std::uint64_t accesses = 0;
  std::uint64_t at = 0;

 private:
  alignas(kPage) std::array<std::uint32_t, kPages * kPage / 4> memory{};
};

}  // namespace hvp::test::registers
