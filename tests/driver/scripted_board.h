#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "driver/hvp_driver.h"
#include "vp/fpga/register_bank.h"

namespace hvp::test {

// The board behind the driver without a simulator: the register bank, the commands as
// docs/registers.md states them, a clock that every access moves on by a microsecond, and no
// arithmetic but what a test scripts. Keeps a log of what came over the bus.
class ScriptedBoard {
 public:
  static constexpr std::uint64_t kAccessNs = 1000;

  explicit ScriptedBoard(const vp::Capacity& capacity = {.nodes = 64, .blocks = 1024});
  ScriptedBoard(const ScriptedBoard&) = delete;
  ScriptedBoard& operator=(const ScriptedBoard&) = delete;

  hvp_bus bus();

  vp::RegisterBank& bank() { return bank_; }
  // "write CONTROL 0x1", "write B[+0x0] x3", "read STATUS", "wait"; cleared by take_log().
  std::vector<std::string> take_log();
  // What illegal accesses were, in the bank's words.
  const std::vector<std::string>& refused() const { return refused_; }
  std::uint64_t now_ns() const { return now_; }

  // The host's memory as the DMA engine reaches it: where the processor sees a word, at which
  // address the board does, and what the board reads there.
  static constexpr std::uint64_t kMemoryAddress = 0x1'0000'0000;
  std::uint32_t* memory(std::size_t word) { return &memory_[word]; }
  static std::uint64_t address(std::size_t word) { return kMemoryAddress + 4 * word; }
  std::uint32_t fetched(std::size_t word) const;

  // The script.
  std::uint64_t job_ns = 500'000;
  std::uint64_t load_ns = 20'000;
  std::function<void(vp::RegisterBank&)> solve = [](vp::RegisterBank&) {};
  vp::ErrorCode end_with = vp::ErrorCode::none;  // how the next commands end
  bool hangs = false;                            // commands never end
  bool loses_interrupts = false;
  int spurious_interrupts = 0;  // the line of a shared interrupt, so often
  bool bus_fails = false;       // wait_interrupt reports a failure
  int gives_up_with = 0;        // the caller's own number, if wait_interrupt is interrupted
  bool dead = false;            // nobody answers: reads give ones
  // Of lists.
  bool loses_record = false;
  std::uint32_t job_offset = 0;  // the record is another job's
  std::uint32_t short_by = 0;    // bytes of U that stay on the board
  std::uint64_t posted_ns = 0;   // writes to memory arrive so late; a read of the board is behind

 private:
  enum class Running { nothing, job, load, update };

  struct Descriptor {
    std::uint32_t bytes;
    std::size_t word;  // of memory
    std::uint32_t offset;
  };

  void control(std::uint32_t written);
  void begin(Running what, std::uint64_t duration);
  void end();
  void raise(vp::ErrorCode code, std::uint32_t detail);
  void mirror_interrupts();
  void check_matrix();
  bool unreachable() const;
  Descriptor descriptor(std::size_t list, std::uint32_t i) const;
  void bring_b();
  void bring(vp::Aperture aperture, const Descriptor& descriptor);
  void bring_values();
  void take_out_u();
  void deliver();
  void place(std::size_t word, std::uint32_t value);
  void update_node();
  void transfer(vp::Command command, std::uint32_t offset, std::uint32_t* words, std::size_t count);
  void advance(std::uint64_t ns);
  bool line_is_up() const;
  int wait_interrupt(std::uint64_t timeout_ns);

  vp::RegisterBank bank_;
  std::vector<std::string> log_;
  std::vector<std::string> refused_;
  std::uint64_t now_ = 0;
  std::uint64_t end_ = 0;
  std::vector<std::uint32_t> memory_ = std::vector<std::uint32_t>(4096);
  struct Posted {
    std::size_t word;
    std::uint32_t value;
  };
  std::vector<Posted> posted_;
  std::uint64_t deliver_at_ = 0;
  bool list_ = false;
  bool fetches_ = false;
  std::uint32_t to_board_ = 0;
  std::uint32_t to_host_ = 0;
  Running running_ = Running::nothing;
};

}  // namespace hvp::test
