#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "vp/bus/host_memory.h"
#include "vp/fpga/dma_engine.h"
#include "vp/fpga/register_bank.h"
#include "vp/function/driver_finding.h"
#include "vp/function/outside_host.h"
#include "vp/function/owned_memory.h"

namespace hvp::vp {

// Watches the driver of a host that is not simulated. It makes no access, takes no time and
// schedules nothing; a run that does not ask for it constructs none.
class DriverRules : public AccessObserver,
                    private MasterObserver,
                    private MemoryObserver,
                    private OutsideHost::Observer {
 public:
  // A wait for longer than this counts as one without a time-out: a second, which is five hundred
  // of the thesis' periods (§2.4).
  static constexpr Picoseconds kLongestWait = Picoseconds{1'000'000} * 1'000'000;

  // Is to be given to the board as its observer; accesses are passed on to `next`, which may be
  // null.
  explicit DriverRules(AccessObserver* next = nullptr) : next_(next) {}
  // To be called once, before the simulation begins. Keeps a reference.
  void watch(BoardFunction& board);
  // Calls this at the first of each rule.
  void report_to(std::function<void(const DriverFinding&)> listener) {
    listener_ = std::move(listener);
  }
  // A host whose stack can be looked into: `look` is called at each access as it is asked for, and
  // `say`, which sets a finding's program_counter and function, at the first of each rule.
  void locate(std::function<HostPlace()> look,
              std::function<void(const HostPlace&, DriverFinding&)> say) {
    look_ = std::move(look);
    say_ = std::move(say);
  }
  // No access follows.
  void finish();
  // The report was taken: what follows is no driver's, such as the end of a guest.
  void stop() { over_ = true; }

  DriverReport report() const;

  // AccessObserver
  void access(Picoseconds time, Command command, const RegisterBank& bank,
              const AccessResult& outcome, std::uint64_t offset,
              std::span<const std::uint8_t> data) override;

 private:
  void transferred(const MasterAccess& access) override;
  void to_be_moved(bool read, std::uint64_t address, std::size_t bytes) override;
  void unordered(bool read, std::uint64_t address, std::size_t bytes) override;
  void refused(const std::string& why, bool allowed) override;
  void unmapped(std::uint64_t address, std::uint64_t bytes) override;
  void asked(const OutsideHost::Access& access) override;
  void ended(const OutsideHost::Access& /*access*/) override {
    if (!places_.empty()) places_.pop_front();
  }
  void message(const ConfigSpace::Message& /*message*/) override { interrupted(); }
  void line(bool up) override {
    if (up) interrupted();
  }
  void interrupted();
  void line_left_up() override;
  void line_blocked() override;
  void board_was_reset() override;

  void judge_read(const RegisterBank& bank, const AccessResult& outcome, std::uint64_t offset,
                  std::size_t bytes);
  void judge_write(Picoseconds time, const RegisterBank& bank, std::uint64_t offset,
                   std::span<const std::uint8_t> data);
  void judge_command(Picoseconds time, const RegisterBank& bank, std::uint32_t commands);
  void judge_start(Picoseconds time, const RegisterBank& bank, bool listed);
  void judge_fetch(Picoseconds time, const RegisterBank& bank);
  void judge_list(const RegisterBank& bank);
  std::optional<Register> missing_of(std::span<const Register> needed) const;
  bool job_has_ended() const;
  // Of a job without a list, whose end nobody has seen.
  bool awaits_look() const { return started_ && !fetches_ && !listed_ && !end_seen_; }
  void judge_numbers(const RegisterBank& bank, std::uint64_t offset,
                     std::span<const std::uint8_t> data);
  void take_list(bool of_values);
  void forget_job();
  // `text` returns what is said of the first, and is called for that alone.
  template <class Text>
  void found(DriverRule rule, const Text& text) {
    DriverFinding* const first = first_of(rule);
    if (first == nullptr) return;
    first->what = text();
    tell(*first);
  }
  DriverFinding* first_of(DriverRule rule);
  void tell(DriverFinding& finding) const;

  AccessObserver* next_;
  BoardFunction* board_ = nullptr;
  std::function<void(const DriverFinding&)> listener_;
  std::array<DriverFinding, kDriverRules> findings_{};
  std::function<HostPlace()> look_;
  std::function<void(const HostPlace&, DriverFinding&)> say_;
  std::deque<HostPlace> places_;  // of the accesses that have not ended
  HostPlace place_{};             // of what is judged
  HostPlace started_from_{};      // of the job that was started last
  bool over_ = false;
  std::int64_t accesses_ = 0;
  Picoseconds last_access_ = -1;

  // The job that was started last, or the values that were fetched last.
  bool started_ = false;
  bool fetches_ = false;
  bool listed_ = false;
  bool end_seen_ = false;  // of one without a list
  Picoseconds started_at_ = 0;

  // As the host has posted it: the last end is acknowledged, and was at the last start.
  bool acknowledged_ = false;
  bool acknowledged_at_start_ = false;
  bool command_ignored_ = false;  // one, since the pending error came up

  // The board's state behind the last access.
  bool error_pending_ = false;
  bool loaded_ = false;
  std::string unloaded_by_;  // a register, or empty
  bool line_blocked_ = false;

  // DMA_LIST_LOW to DMA_VALUES_COUNT as the host has posted them, and whether since the last reset.
  static constexpr std::size_t kListRegisters = 8;
  std::array<std::uint32_t, kListRegisters> list_{};
  std::array<bool, kListRegisters> list_set_{};
  std::optional<Register> list_lacks_;  // at the last doorbell
  OwnedMemory owned_;
  bool values_rung_ = false;    // the doorbell for values has not reached the board
  std::uint64_t to_board_ = 0;  // bytes of the list's descriptors
  std::uint64_t to_host_ = 0;
};

}  // namespace hvp::vp
