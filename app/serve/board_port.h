#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>

#include "app/results/register_trace.h"
#include "app/serve/function_port.h"
#include "app/serve/interrupts.h"
#include "vp/function/board_function.h"

namespace hvp::serve {

// The simulated board behind the protocol, and the rule by which its time passes: with accesses,
// and, while a client waits, as long as there is something that it may wait for. That is a job or
// the check of a matrix under way, or what an access has left behind on the bus (posted writes, a
// message): kSettle after the last access or the end of the job. Effects that go on for ever, such
// as [bus.traffic], move nothing by themselves, and a board that never ends is given up kLongest
// after the last access.
class BoardPort : public FunctionPort, private vp::InterruptListener {
 public:
  static constexpr vp::Picoseconds kSettle = 1'000'000'000;        // 1 ms
  static constexpr vp::Picoseconds kLongest = 10'000'000'000'000;  // 10 s

  // `registers`: what is told of every access; null: nobody.
  explicit BoardPort(const vp::PlatformSettings& settings,
                     results::RegisterTrace* registers = nullptr);

  // Who is told of interrupts; null: nobody.
  void tell(Interrupts* interrupts);

  // Whether advance() would do anything.
  bool has_work();
  // A piece of simulated time: until the next event, or some more of them.
  void advance();

  // FunctionPort
  void read_config(std::uint64_t offset, std::span<std::uint8_t> data) override;
  void write_config(std::uint64_t offset, std::span<const std::uint8_t> data) override;
  std::uint64_t config_bytes() const override { return vp::ConfigSpace::kBytes; }
  bool read_bar(std::uint64_t offset, std::span<std::uint8_t> data) override;
  bool write_bar(std::uint64_t offset, std::span<const std::uint8_t> data) override;
  std::uint64_t bar_bytes() const override;
  void map(std::uint64_t address, std::span<std::uint8_t> memory, bool writable) override;
  void unmap(std::uint64_t address, std::uint64_t bytes) override;
  void before_memory(std::function<void()> look) override { look_at_memory_ = std::move(look); }
  void reset() override;
  bool has_messages() const override { return has_messages_; }
  bool line_is_up() const override { return board_.host().line_is_up(); }

 private:
  void message(const vp::ConfigSpace::Message& message) override;
  void line(bool up) override;
  void accessed();
  void show_errors();
  bool busy();

  // Its parts are asked through members that are not const.
  mutable vp::BoardFunction board_;
  bool has_messages_;
  std::function<void()> look_at_memory_;
  Interrupts* interrupts_ = nullptr;
  vp::Picoseconds last_access_ = 0;
  vp::Picoseconds awake_until_ = 0;
};

}  // namespace hvp::serve
