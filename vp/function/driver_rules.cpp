#include "vp/function/driver_rules.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "driver/hvp_status.h"
#include "models/time/picoseconds.h"
#include "vp/function/access_words.h"

namespace hvp::vp {

namespace {

bool reaches(std::uint64_t offset, std::size_t bytes, Register reg) {
  return overlap(offset, bytes, offset_of(reg), 4);
}

bool is_result(std::uint64_t offset, std::size_t bytes) {
  const std::uint64_t first = offset_of(Register::result_iterations);
  const std::uint64_t end = offset_of(Register::result_cycles_high) + 4;
  const auto& u = kApertures[static_cast<std::size_t>(Aperture::u)];
  return overlap(offset, bytes, first, end - first) || overlap(offset, bytes, u.offset, u.size);
}

}  // namespace

void DriverRules::watch(BoardFunction& board) {
  board_ = &board;
  board.host().observe(*this);
  if (board.accelerator().dma() != nullptr) board.accelerator().dma()->observe(*this);
  if (board.memory() != nullptr) board.memory()->observe(*this);
}

DriverFinding* DriverRules::first_of(DriverRule rule) {
  if (over_) return nullptr;
  DriverFinding& finding = findings_[static_cast<std::size_t>(rule)];
  if (finding.count++ > 0) return nullptr;
  finding.rule = rule;
  finding.first = now_ps();
  finding.job = board_->host().frames().jobs() - 1;
  finding.access = accesses_;
  return &finding;
}

void DriverRules::tell(DriverFinding& finding) const {
  if (say_) say_(place_, finding);
  if (listener_) listener_(finding);
}

DriverReport DriverRules::report() const {
  DriverReport report{.accesses = accesses_, .findings = {}};
  std::ranges::copy_if(findings_, std::back_inserter(report.findings),
                       [](const DriverFinding& one) { return one.count > 0; });
  std::ranges::stable_sort(report.findings, {}, &DriverFinding::first);
  return report;
}

bool DriverRules::job_has_ended() const {
  return board_->accelerator().job_end().time >= started_at_;
}

void DriverRules::access(Picoseconds time, Command command, const RegisterBank& bank,
                         const AccessResult& outcome, std::uint64_t offset,
                         std::span<const std::uint8_t> data) {
  if (next_ != nullptr) next_->access(time, command, bank, outcome, offset, data);
  if (board_ == nullptr) return;
  ++accesses_;
  place_ = places_.empty() ? HostPlace{} : places_.front();
  if (command == Command::write && word_for(Register::control, offset, data)) values_rung_ = false;
  if (!outcome.ok() && outcome.access != Access::busy) {
    found(DriverRule::illegal_access, [&] { return bank.describe(outcome, command); });
  } else if (command == Command::read) {
    judge_read(bank, outcome, offset, data.size());
  } else if (!outcome.ok()) {
    found(DriverRule::access_while_busy, [&] { return bank.describe(outcome, command); });
  } else {
    judge_write(time, bank, offset, data);
  }
  error_pending_ = bank.get(field::kInterruptStatusError) != 0;
  if (!error_pending_) command_ignored_ = false;
  loaded_ = bank.get(field::kStatusMatrixLoaded) != 0;
  if (loaded_) unloaded_by_.clear();
  last_access_ = time;
}

void DriverRules::judge_read(const RegisterBank& bank, const AccessResult& outcome,
                             std::uint64_t offset, std::size_t bytes) {
  const bool busy = bank.get(field::kStatusBusy) != 0;
  const bool asks = reaches(offset, bytes, Register::status) ||
                    reaches(offset, bytes, Register::interrupt_status) ||
                    reaches(offset, bytes, Register::result_job);
  if (asks && !busy) end_seen_ = true;
  if (awaits_look() && !asks && is_result(offset, bytes)) {
    found(DriverRule::early_result, [&] {
      return fmt::format(
          "{} was read {}", bank.name_at(offset),
          busy ? "while the job runs" : "before the host saw that the job has ended");
    });
    if (!busy) end_seen_ = true;  // said once a job
  } else if (!outcome.ok()) {
    found(DriverRule::access_while_busy, [&] { return bank.describe(outcome, Command::read); });
  }
}

void DriverRules::judge_write(Picoseconds time, const RegisterBank& bank, std::uint64_t offset,
                              std::span<const std::uint8_t> data) {
  judge_numbers(bank, offset, data);
  if (const auto word = word_for(Register::control, offset, data)) {
    judge_command(time, bank, *word);
  } else if (loaded_ && bank.get(field::kStatusMatrixLoaded) == 0) {
    unloaded_by_ = bank.name_at(offset);
  }
  if (line_blocked_ && bank.get(field::kInterruptStatusDone) == 0 &&
      bank.get(field::kInterruptStatusError) == 0) {
    line_blocked_ = false;
    found(DriverRule::interrupt_blocked, [] {
      return std::string(
          "the interrupt was acknowledged, and the host never got it: neither INTA# "
          "(COMMAND) nor messages are enabled");
    });
  }
}

void DriverRules::judge_numbers(const RegisterBank& bank, std::uint64_t offset,
                                std::span<const std::uint8_t> data) {
  struct Number {
    Register reg;
    std::uint32_t most;
  };
  const std::array numbers = {
      Number{Register::nodes, bank.get(field::kCapabilityNodesMaxNodes)},
      Number{Register::blocks, bank.get(field::kCapabilityBlocksMaxBlocks)},
      Number{Register::iterations, 0xffff},
      Number{Register::interrupt_enable, 3},
      Number{Register::control, field::kControlStart.mask() | field::kControlUpdateNode.mask() |
                                    field::kControlLoadDone.mask() | field::kControlRunList.mask() |
                                    field::kControlUpdateValues.mask() |
                                    field::kControlFetchValues.mask()},
  };
  const auto judge = [&](std::uint64_t place, std::uint32_t word, std::uint32_t most) {
    if (word <= most || turned(word) > most) return;
    found(DriverRule::byte_order, [&] {
      return fmt::format(
          "{:#x} was written to {}, which takes up to {:#x}: its bytes the other way "
          "round are {:#x}",
          word, bank.name_at(place), most, turned(word));
    });
  };
  for (const Number& number : numbers) {
    const std::optional<std::uint32_t> word = word_for(number.reg, offset, data);
    if (word) judge(offset_of(number.reg), *word, number.most);
  }
  for (const auto& [aperture, most] :
       {std::pair(Aperture::row_begin, bank.get(field::kCapabilityBlocksMaxBlocks)),
        std::pair(Aperture::column, bank.get(field::kCapabilityNodesMaxNodes))}) {
    const auto& place = kApertures[static_cast<std::size_t>(aperture)];
    if (offset < place.offset || offset - place.offset >= place.size) continue;
    for (std::size_t at = 0; at + 4 <= data.size(); at += 4) {
      judge(offset + at, word_at(data, at), most);
    }
  }
}

void DriverRules::judge_command(Picoseconds time, const RegisterBank& bank,
                                std::uint32_t commands) {
  const auto given = [commands](Field command) { return (commands & command.mask()) != 0; };
  if (given(field::kControlReset)) {
    forget_job();
    return;
  }
  // A job may have ended in an error since the last access.
  const JobEnd& end = board_->accelerator().job_end();
  const bool failed = end.time >= last_access_ && end.time <= time && end.status != HVP_OK &&
                      end.status != HVP_ERROR_SHORT_TRANSFER;
  if (commands != 0 && (error_pending_ || failed)) {
    // The first may be how a driver comes to look.
    const bool again = std::exchange(command_ignored_, true);
    if (!again) return;
    found(DriverRule::command_ignored, [&] {
      return fmt::format("{:#x} was written to CONTROL while error {} was pending", commands,
                         bank.get(field::kErrorCode));
    });
    return;
  }
  if (given(field::kControlStart)) {
    judge_start(time, bank, false);
  } else if (given(field::kControlRunList)) {
    judge_start(time, bank, true);
  } else if (given(field::kControlFetchValues) && !given(field::kControlLoadDone)) {
    judge_fetch(time, bank);
  }
}

void DriverRules::judge_list(const RegisterBank& bank) {
  if (!list_lacks_) return;
  found(DriverRule::list_not_set, [&] {
    return fmt::format("the doorbell was rung, and {} was not written since the last reset",
                       bank.name_at(offset_of(*list_lacks_)));
  });
}

// Its end is in STATUS, as no record tells of it.
void DriverRules::judge_fetch(Picoseconds time, const RegisterBank& bank) {
  judge_list(bank);
  started_ = bank.get(field::kStatusBusy) != 0;
  fetches_ = true;
  listed_ = end_seen_ = false;
  started_at_ = time;
  started_from_ = place_;
}

void DriverRules::judge_start(Picoseconds time, const RegisterBank& bank, bool listed) {
  // An acknowledgement may be lost on its way.
  if (!listed && bank.get(field::kInterruptStatusDone) != 0 && !acknowledged_at_start_) {
    found(DriverRule::start_unacknowledged, [] {
      return std::string("a job was started while INTERRUPT_STATUS.done of an earlier end was set");
    });
  }
  if (awaits_look()) {
    found(DriverRule::end_not_seen, [] {
      return std::string(
          "a job was started, and the host had not seen that the one before has "
          "ended");
    });
  }
  if (bank.get(field::kStatusMatrixLoaded) == 0 && !unloaded_by_.empty()) {
    found(DriverRule::unloaded_matrix, [&] {
      return fmt::format("a job was started, and a write to {} had unloaded the matrix",
                         unloaded_by_);
    });
  }
  if (listed) judge_list(bank);
  fetches_ = false;
  started_ = bank.get(field::kStatusBusy) != 0;
  listed_ = listed;
  end_seen_ = false;
  started_at_ = time;
  started_from_ = place_;
  to_board_ = to_host_ = 0;
}

// Only the end of a run tells a long wait from one without a time-out.
void DriverRules::finish() {
  if (board_ == nullptr || !started_ || now_ps() - started_at_ <= kLongestWait) return;
  if (job_has_ended() && (listed_ || end_seen_)) return;
  started_ = false;
  place_ = started_from_;
  found(DriverRule::endless_wait, [&] {
    return fmt::format("the host still waits for {} at {}.{:03} ns and {}",
                       fetches_ ? "values that were asked for" : "a job that was started",
                       started_at_ / 1000, started_at_ % 1000,
                       job_has_ended() ? "has ended" : "has no end");
  });
}

void DriverRules::forget_job() {
  started_ = false;
  line_blocked_ = false;
  owned_.give_back();
  unloaded_by_.clear();
}

void DriverRules::board_was_reset() {
  forget_job();
  list_set_ = {};
}

void DriverRules::interrupted() {
  line_blocked_ = false;
  if (started_ && job_has_ended()) end_seen_ = true;
}

void DriverRules::line_left_up() {
  place_ = {};
  found(DriverRule::line_left_up, [] {
    return std::string("the handler has returned, all that it wrote has arrived, and INTA# is up");
  });
}

void DriverRules::line_blocked() { line_blocked_ = true; }

}  // namespace hvp::vp
