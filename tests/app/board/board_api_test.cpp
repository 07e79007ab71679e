// The board in a program that knows neither SystemC nor C++: through its C calls alone.
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/board/hvp_board.h"

namespace {

constexpr const char* kScenario = HVP_SCENARIOS "/thesis.toml";

const std::array<std::int32_t, 2> kRowBegin = {0, 1};
const std::array<std::int32_t, 1> kColumn = {0};
const std::array<std::int32_t, 9> kValue = {64, 0, 0, 0, 32, 0, 0, 0, 16};

class BoardApi : public testing::Test {
 protected:
  void open(std::vector<const char*> overrides = {}) {
    const hvp_board_options options = {overrides.data(), overrides.size(), nullptr, false, nullptr};
    board = hvp_board_open(kScenario, &options, why.data(), why.size());
    ASSERT_NE(board, nullptr) << why.data();
    EXPECT_STREQ(why.data(), "");
  }
  std::string refusal(const char* scenario, std::vector<const char*> overrides = {}) {
    const hvp_board_options options = {overrides.data(), overrides.size(), nullptr, false, nullptr};
    board = hvp_board_open(scenario, &options, why.data(), why.size());
    EXPECT_EQ(board, nullptr);
    return why.data();
  }
  void load() {
    ASSERT_EQ(hvp_open(&device, hvp_board_bus(board), scratch.data(), scratch.size()), HVP_OK);
    hvp_solver_config config{};
    config.method = HVP_METHOD_JACOBI_PCG;
    config.iterations = 4;
    config.matrix_bits = 12;
    config.vector_bits = 16;
    config.coefficient_bits = 16;
    config.dynamic_scaling = true;
    ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
    const hvp_matrix k = {1, 1, kRowBegin.data(), kColumn.data(), kValue.data()};
    ASSERT_EQ(hvp_load_matrix(&device, &k), HVP_OK);
  }
  void solve() {
    ASSERT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), 1'000'000), HVP_OK);
    EXPECT_EQ(u, (std::array<std::int32_t, 3>{10, 20, 40}));
  }
  void TearDown() override { hvp_board_close(board); }

  std::array<char, 256> why{};
  hvp_board* board = nullptr;
  hvp_device device{};
  std::array<std::uint32_t, 16> scratch{};
  std::array<std::int32_t, 3> b = {640, 640, 640};
  std::array<std::int32_t, 3> u{};
};

TEST_F(BoardApi, SolvesAndSaysWhatAJobTook) {
  open();
  load();
  for (std::uint64_t n = 0; n < 3; ++n) {
    const std::uint64_t began = hvp_board_now_ps(board);
    solve();
    const std::uint64_t ended = hvp_board_now_ps(board);
    hvp_board_job job{};
    ASSERT_TRUE(hvp_board_last_job(board, &job));
    EXPECT_EQ(job.number, n);
    EXPECT_EQ(job.begin_ps, began);
    EXPECT_EQ(job.end_ps, ended);
    EXPECT_EQ(job.host_ps + job.bus_ps + job.fpga_ps, ended - began);
    EXPECT_GT(job.fpga_ps, 0U);
    hvp_result result{};
    ASSERT_EQ(hvp_read_result(&device, &result), HVP_OK);
    // The thesis' board: 100 MHz.
    EXPECT_EQ(job.fpga_ps, 10'000 * result.cycles);
  }
}

TEST_F(BoardApi, IsEnumerated) {
  open();
  EXPECT_EQ(hvp_board_config_read(board, 0, 4), 0x4850'1172U);
  EXPECT_EQ(hvp_board_config_read(board, 4, 2), 6U);
  std::uint32_t id = 0;
  hvp_board_read(board, 0, &id, 4);
  EXPECT_EQ(id, 0x4856'5031U);
  hvp_board_config_write(board, 4, 0, 2);
  hvp_board_read(board, 0, &id, 4);
  EXPECT_EQ(id, 0xffff'ffffU);
  EXPECT_EQ(hvp_board_config_read(board, 0, 3), 0x00ff'ffffU);
  EXPECT_EQ(hvp_board_config_read(board, 0, 0), 0U);
}

TEST_F(BoardApi, TimeIsTheHosts) {
  open();
  EXPECT_EQ(hvp_board_now_ps(board), 0U);
  EXPECT_TRUE(hvp_board_run_until_ps(board, 5'000'000));
  EXPECT_EQ(hvp_board_now_ps(board), 5'000'000U);
  std::uint64_t when = 0;
  EXPECT_FALSE(hvp_board_next_event_ps(board, &when));
  load();
  ASSERT_EQ(hvp_write_rhs(&device, b.data(), b.size()), HVP_OK);
  ASSERT_EQ(hvp_start(&device), HVP_OK);
  ASSERT_TRUE(hvp_board_next_event_ps(board, &when));
  EXPECT_FALSE(hvp_board_interrupt(board));
  EXPECT_FALSE(hvp_board_run_until_ps(board, when + 1'000'000));  // stops at the interrupt
  EXPECT_EQ(hvp_board_now_ps(board), when);
  EXPECT_TRUE(hvp_board_interrupt(board));
}

TEST_F(BoardApi, WaitingEndsWithTheTimeOut) {
  open();
  load();
  ASSERT_EQ(hvp_write_rhs(&device, b.data(), b.size()), HVP_OK);
  ASSERT_EQ(hvp_start(&device), HVP_OK);
  const std::uint64_t began = hvp_board_now_ps(board);
  EXPECT_EQ(hvp_wait(&device, 1), HVP_ERROR_TIMEOUT);
  EXPECT_GE(hvp_board_now_ps(board), began + 1'000);
  EXPECT_EQ(hvp_wait(&device, 1'000'000), HVP_OK);
}

TEST_F(BoardApi, PollsWithoutInterrupts) {
  open({"transfer.notification=polling"});
  load();
  solve();
}

// Memory of the program's for a board that is a bus master, at bus addresses beyond 32 bits.
struct Memory {
  static constexpr std::uint64_t kAt = 0x1'2340'0000;

  std::vector<std::uint32_t> words = std::vector<std::uint32_t>(1024);
  hvp_segment to_board{words.data() + 256, kAt + 1024, 1024};
  hvp_segment to_host{words.data() + 512, kAt + 2048, 1024};
  hvp_dma dma{.to_board = &to_board,
              .to_board_count = 1,
              .to_host = &to_host,
              .to_host_count = 1,
              .list = words.data(),
              .list_address = kAt,
              .record = words.data() + 128,
              .record_address = kAt + 512,
              .values = nullptr,
              .values_count = 0,
              .values_list = nullptr,
              .values_list_address = 0,
              .context = nullptr,
              .sync = nullptr};
};

TEST_F(BoardApi, MovesDataByItself) {
  open({"transfer.method=dma", "transfer.notification=msi"});
  Memory memory;
  std::vector<std::uint32_t>& words = memory.words;
  ASSERT_TRUE(hvp_board_map(board, Memory::kAt, words.data(), 4 * words.size()));
  EXPECT_FALSE(hvp_board_map(board, Memory::kAt + 64, words.data(), 4));
  EXPECT_FALSE(hvp_board_map(board, 0xfee0'0000, words.data(), 4));
  EXPECT_FALSE(hvp_board_map(board, 0, nullptr, 4));
  load();
  ASSERT_EQ(hvp_use_dma(&device, &memory.dma), HVP_OK);
  solve();
  EXPECT_FALSE(hvp_board_unmap(board, Memory::kAt + 4, 8));
  EXPECT_TRUE(hvp_board_unmap(board, Memory::kAt, 4096));
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), 1'000'000), HVP_ERROR_DMA);
}

// CRC-32 (IEEE 802.3 §3.2.9), bit by bit.
std::uint32_t checksum(const void* data, std::size_t bytes) {
  std::uint32_t crc = 0xffff'ffff;
  for (std::size_t i = 0; i < bytes; ++i) {
    crc ^= static_cast<const std::uint8_t*>(data)[i];
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1U) != 0 ? 0xedb8'8320U : 0U);
  }
  return ~crc;
}

std::vector<std::vector<std::string>> lines_of(const std::string& path) {
  std::vector<std::vector<std::string>> lines;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    lines.emplace_back(std::istream_iterator<std::string>(words),
                       std::istream_iterator<std::string>());
  }
  return lines;
}

// Each transaction of the board's own is in dma.log; one that goes astray is named, with the memory
// that lies nearest.
TEST_F(BoardApi, WritesWhatTheBoardMoved) {
  const std::string folder = testing::TempDir() + "board_api_dma";
  const std::array<const char*, 2> keys = {"transfer.method=dma", "transfer.notification=msi"};
  const hvp_board_options options = {keys.data(), keys.size(), folder.c_str(), false, nullptr};
  board = hvp_board_open(kScenario, &options, why.data(), why.size());
  ASSERT_NE(board, nullptr) << why.data();
  Memory memory;
  ASSERT_TRUE(hvp_board_map(board, Memory::kAt, memory.words.data(), 4 * memory.words.size()));
  load();
  ASSERT_EQ(hvp_use_dma(&device, &memory.dma), HVP_OK);
  solve();
  const std::uint32_t of_b = checksum(memory.to_board.memory, 12);
  const std::uint32_t of_u = checksum(memory.to_host.memory, 8);
  memory.to_host.bus_address += 0x10'0000;  // a driver's slip
  ASSERT_EQ(hvp_use_dma(&device, &memory.dma), HVP_OK);
  testing::internal::CaptureStderr();
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), 1'000'000), HVP_ERROR_DMA);
  const std::string warning = testing::internal::GetCapturedStderr();
  EXPECT_NE(warning.find("write of 8 bytes at 0x123500800, in job 1, at "), std::string::npos);
  EXPECT_NE(warning.find("the nearest memory is from 0x123400000 to 0x123400fff\n"),
            std::string::npos)
      << warning;
  hvp_board_close(board);
  board = nullptr;
  const auto lines = lines_of(folder + "/dma.log");
  // The check of the matrix sends a message, before the first job.
  std::vector<std::string> moved;
  for (const auto& line : lines) {
    if (line.front() == "#") continue;
    ASSERT_EQ(line.size(), 9U);
    moved.push_back(line[2] + " " + line[3] + " " + line[4] + " " + line[8]);
  }
  EXPECT_EQ(moved,
            (std::vector<std::string>{"-1 write message ok", "0 read descriptors ok", "0 read b ok",
                                      "0 write U ok", "0 write record ok", "0 write message ok",
                                      "1 read descriptors ok", "1 read b ok", "1 write U refused",
                                      "1 write record ok", "1 write message ok"}));
  EXPECT_EQ(std::stoul(lines.at(3).at(7), nullptr, 16), of_b);
  EXPECT_EQ(std::stoul(lines.at(4).at(7), nullptr, 16), of_u);
  EXPECT_EQ(lines.at(4).at(5), "0x123400800");
  std::filesystem::remove_all(folder);
}

// A BAR of two words, above 4 GiB, and the capability of the scenario's link; the words are those
// of any board.
TEST_F(BoardApi, HasTheFunctionThatTheScenarioAsksFor) {
  open({"bus.pcie.generation=gen1", "bus.pcie.lanes=4", "transfer.method=programmed-io",
        "function.pci_express=true", "function.bar_bits=64"});
  EXPECT_EQ(hvp_board_config_read(board, 0x10, 4), 4U);
  hvp_board_config_write(board, 0x10, 0xffff'ffff, 4);
  hvp_board_config_write(board, 0x14, 0xffff'ffff, 4);
  EXPECT_EQ(hvp_board_config_read(board, 0x10, 4), 0xfe00'0004U);
  EXPECT_EQ(hvp_board_config_read(board, 0x14, 4), 0xffff'ffffU);
  hvp_board_config_write(board, 0x10, 0, 4);
  hvp_board_config_write(board, 0x14, 0x38, 4);
  EXPECT_EQ(hvp_board_config_read(board, 0x80, 1), 0x10U);
  EXPECT_EQ(hvp_board_config_read(board, 0x92, 2), 0x41U);  // four lanes of 2.5 GT/s
  EXPECT_EQ(hvp_board_config_read(board, 0xffc, 4), 0U);
  load();
  solve();
  hvp_board_config_write(board, 0x88, 0x8000, 2);  // a reset of the function
  EXPECT_EQ(hvp_board_config_read(board, 4, 2), 0U);
  std::uint32_t id = 0;
  hvp_board_read(board, 0, &id, sizeof id);
  EXPECT_EQ(id, 0xffff'ffffU);
}

// Capability and status of advanced error reporting.
TEST_F(BoardApi, NotesErrorsOfALink) {
  open({"bus.pcie.generation=gen1", "transfer.method=programmed-io", "function.pci_express=true",
        "fault[0].kind=aer-correctable", "fault[0].frame=0", "fault[1].kind=aer-uncorrectable",
        "fault[1].frame=1", "fault[1].access=start"});
  EXPECT_EQ(hvp_board_config_read(board, 0x100, 4), 0x1'0001U);
  load();
  EXPECT_EQ(hvp_board_config_read(board, 0x110, 4), 0U);
  solve();
  EXPECT_EQ(hvp_board_config_read(board, 0x110, 4), 0x40U);
  EXPECT_EQ(hvp_board_config_read(board, 0x104, 4), 0U);
  EXPECT_EQ(hvp_board_config_read(board, 0x8a, 2), 1U);
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), 1'000'000), HVP_ERROR_DATA);
  EXPECT_EQ(hvp_board_config_read(board, 0x104, 4), 0x1000U);
  EXPECT_EQ(hvp_board_config_read(board, 0x8a, 2), 3U);
}

// The vector is unmasked when the board is opened; masked, its message is pending until it is not.
TEST_F(BoardApi, HasATableOfMessages) {
  open({"transfer.notification=msi", "function.msi_x=true"});
  EXPECT_EQ(hvp_board_config_read(board, 0xc0, 1), 0x11U);
  EXPECT_EQ(hvp_board_config_read(board, 0xc2, 2), 0x8000U);
  EXPECT_EQ(hvp_board_table_read(board, 0), 0xfee0'0000U);
  EXPECT_EQ(hvp_board_table_read(board, 12), 0U);
  load();
  solve();
  hvp_board_table_write(board, 12, 1);
  ASSERT_EQ(hvp_write_rhs(&device, b.data(), b.size()), HVP_OK);
  ASSERT_EQ(hvp_start(&device), HVP_OK);
  while (!hvp_board_run_until_ps(board, hvp_board_now_ps(board) + 1'000'000'000)) continue;
  EXPECT_FALSE(hvp_board_interrupt(board));
  EXPECT_EQ(hvp_board_table_read(board, 0x800), 1U);
  hvp_board_table_write(board, 12, 0);
  EXPECT_EQ(hvp_board_table_read(board, 0x800), 0U);
  EXPECT_TRUE(hvp_board_interrupt(board));
  EXPECT_EQ(hvp_wait(&device, 0), HVP_OK);
}

TEST_F(BoardApi, AMemoryIsOfNoUseToABoardThatIsNoMaster) {
  open();
  std::array<std::uint32_t, 4> memory{};
  EXPECT_FALSE(hvp_board_map(board, 0, memory.data(), sizeof memory));
  EXPECT_FALSE(hvp_board_unmap(board, 0, 16));
}

TEST_F(BoardApi, RefusesInOneLine) {
  EXPECT_EQ(refusal(nullptr), "hvp_board_open: no scenario file");
  EXPECT_NE(refusal("nowhere.toml").find("nowhere.toml"), std::string::npos);
  const std::string wall = refusal(HVP_SCENARIOS "/wall.toml");
  EXPECT_NE(wall.find("wall.toml"), std::string::npos);
  EXPECT_NE(wall.find("no board"), std::string::npos);
  EXPECT_NE(refusal(kScenario, {"host.solver=cg"}).find("the host solves"), std::string::npos);
  EXPECT_NE(refusal(kScenario, {"fidelity.numbers=none"}).find("numbers"), std::string::npos);
  EXPECT_NE(refusal(kScenario, {"bus.kind=isa"}).find("bus.kind"), std::string::npos);
  EXPECT_NE(refusal(kScenario, {"function.pci_express=true"})
                .find("function.pci_express=true: the board is on the PCI bus and has no link"),
            std::string::npos)
      << why.data();
  EXPECT_NE(refusal(kScenario, {"function.msi_x=true"}).find("the board sends no messages"),
            std::string::npos)
      << why.data();
  EXPECT_NE(refusal(kScenario, {"fault[0].kind=aer-uncorrectable", "fault[0].access=solution",
                                "fault[0].frame=0"})
                .find("only a write is poisoned"),
            std::string::npos)
      << why.data();
  EXPECT_NE(refusal(kScenario, {"fault[0].kind=aer-correctable", "fault[0].frame=0"})
                .find("expected function.pci_express = true"),
            std::string::npos)
      << why.data();
  EXPECT_NE(refusal(kScenario, {"function.bar_bits=48"}).find("expected 32 or 64, found 48"),
            std::string::npos)
      << why.data();
  std::array<char, 8> small{};
  EXPECT_EQ(hvp_board_open("nowhere.toml", nullptr, small.data(), small.size()), nullptr);
  EXPECT_EQ(std::string(small.data()).size(), 7U);
  EXPECT_EQ(hvp_board_open("nowhere.toml", nullptr, nullptr, 0), nullptr);
  open();  // nothing of all that stands in the way
  std::array<char, 256> second{};
  EXPECT_EQ(hvp_board_open(kScenario, nullptr, second.data(), second.size()), nullptr);
  EXPECT_STREQ(second.data(), "hvp_board_open: a process has one board, and it had one");
}

TEST_F(BoardApi, WritesWhatItDidIntoAFolder) {
  const std::string folder = testing::TempDir() + "board_api_trace";
  const hvp_board_options options = {nullptr, 0, folder.c_str(), false, nullptr};
  board = hvp_board_open(kScenario, &options, why.data(), why.size());
  ASSERT_NE(board, nullptr) << why.data();
  load();
  solve();
  hvp_board_close(board);
  board = nullptr;
  std::ifstream log(folder + "/registers.log");
  const std::string text((std::istreambuf_iterator<char>(log)), {});
  EXPECT_NE(text.find(" write CONTROL 4 0x00000001 ok\n"), std::string::npos) << text;
  EXPECT_TRUE(std::ifstream(folder + "/registers.vcd").good());
  std::filesystem::remove_all(folder);
}

TEST_F(BoardApi, NothingCanBeClosed) { hvp_board_close(nullptr); }

}  // namespace
