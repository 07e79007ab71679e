#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>

#include "app/board/model_commands.h"
#include "app/results/board_records.h"
#include "app/serve/function_port.h"
#include "app/serve/interrupts.h"
#include "vp/function/driver_rules.h"
#include "vp/function/outside_host.h"

namespace hvp::serve {

// The simulated board behind the protocol, and the rule by which its time advances. Time advances
// with accesses, and while a client waits for something: a job, the check of a matrix, or what an
// access has left on the bus (posted writes, a message). It stops kSettle after the last access or
// the job's end. Endless effects such as [bus.traffic] do not advance time by themselves, and a
// board that never finishes is abandoned kLongest after the last access.
class BoardPort : public FunctionPort, private vp::InterruptListener {
 public:
  static constexpr vp::Picoseconds kSettle = 1'000'000'000;        // 1 ms
  static constexpr vp::Picoseconds kLongest = 10'000'000'000'000;  // 10 s

  // `registers` records every access, and `rules`, which passes accesses on to it, watches the
  // driver; null: no record, nobody watches.
  explicit BoardPort(const vp::PlatformSettings& settings,
                     results::RegisterTrace* registers = nullptr, vp::DriverRules* rules = nullptr);

  vp::BoardFunction& function() { return board_; }
  // While a client has not asked for a stop that has come, simulated time stands still. Keeps a
  // reference.
  void obey(const app::ModelCommands& commands) { commands_ = &commands; }
  // Sets the receiver of interrupts; null: none.
  void tell(Interrupts* interrupts);

  // True if advance() would do anything.
  bool has_work();
  // Advances simulated time by a step: to the next event, or over several of them.
  void advance();

  // FunctionPort
  void read_config(std::uint64_t offset, std::span<std::uint8_t> data) override;
  void write_config(std::uint64_t offset, std::span<const std::uint8_t> data) override;
  std::uint64_t config_bytes() const override { return board_.config().bytes(); }
  bool read_bar(std::uint64_t offset, std::span<std::uint8_t> data) override;
  bool write_bar(std::uint64_t offset, std::span<const std::uint8_t> data) override;
  std::uint64_t bar_bytes() const override;
  std::uint64_t table_bytes() const override { return board_.config().table_bytes(); }
  void read_table(std::uint64_t offset, std::span<std::uint8_t> data) override;
  void write_table(std::uint64_t offset, std::span<const std::uint8_t> data) override;
  void mask_message(bool masked) override;
  void map(std::uint64_t address, std::span<std::uint8_t> memory, bool writable) override;
  void unmap(std::uint64_t address, std::uint64_t bytes) override;
  void before_memory(std::function<void()> look) override { look_at_memory_ = std::move(look); }
  void reset() override;
  bool has_messages() const override { return has_messages_; }
  bool reports_errors() const override {
    return board_.config().bytes() == vp::ConfigSpace::kExpressBytes;
  }
  bool line_is_up() const override { return board_.host().line_is_up(); }

 private:
  void message(const vp::ConfigSpace::Message& message) override;
  void line(bool up) override;
  void error() override;
  void accessed();
  bool busy();

  // Mutable, because its parts are queried by non-const members.
  mutable vp::BoardFunction board_;
  bool has_messages_;
  std::function<void()> look_at_memory_;
  Interrupts* interrupts_ = nullptr;
  const app::ModelCommands* commands_ = nullptr;
  vp::Picoseconds last_access_ = 0;
  vp::Picoseconds awake_until_ = 0;
};

}  // namespace hvp::serve
