#include "vp/function/driver_rules.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "driver/hvp_status.h"
#include "models/time/picoseconds.h"

namespace hvp::vp {

namespace {

std::uint32_t word_at(std::span<const std::uint8_t> data, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, &data[at], sizeof word);
  return word;
}

constexpr std::uint32_t turned(std::uint32_t v) {
  return v << 24 | (v & 0xff00) << 8 | (v >> 8 & 0xff00) | v >> 24;
}

// True if [offset, offset + bytes) has a part of the other range.
constexpr bool overlap(std::uint64_t a, std::uint64_t a_bytes, std::uint64_t b,
                       std::uint64_t b_bytes) {
  return a < b ? b - a < a_bytes : a - b < b_bytes;
}

bool reaches(std::uint64_t offset, std::size_t bytes, Register reg) {
  return overlap(offset, bytes, offset_of(reg), 4);
}

// The word that an access has for a register; none: it is not one of its words.
std::optional<std::uint32_t> word_for(Register reg, std::uint64_t offset,
                                      std::span<const std::uint8_t> data) {
  const std::uint64_t at = offset_of(reg);
  if (at < offset || at - offset + 4 > data.size()) return std::nullopt;
  return word_at(data, at - offset);
}

bool is_result(std::uint64_t offset, std::size_t bytes) {
  const std::uint64_t first = offset_of(Register::result_iterations);
  const std::uint64_t end = offset_of(Register::result_cycles_high) + 4;
  const auto& u = kApertures[static_cast<std::size_t>(Aperture::u)];
  return overlap(offset, bytes, first, end - first) || overlap(offset, bytes, u.offset, u.size);
}

constexpr std::size_t list_register(Register reg) {
  return static_cast<std::size_t>(reg) - static_cast<std::size_t>(Register::dma_list_low);
}

// The bytes of a vector of the loaded matrix.
std::uint64_t vector_bytes(const RegisterBank& bank, Field bits) {
  return 4 * packed_words(3 * std::size_t{bank.get(field::kNodesCount)}, bank.get(bits),
                          bank.get(field::kPackingMode) != 0);
}

}  // namespace

void DriverRules::watch(BoardFunction& board) {
  board_ = &board;
  board.host().observe(*this);
  if (board.accelerator().dma() != nullptr) board.accelerator().dma()->observe(*this);
  if (board.memory() != nullptr) board.memory()->observe(*this);
}

template <class Text>
void DriverRules::found(DriverRule rule, const Text& text) {
  if (over_) return;
  DriverFinding& finding = findings_[static_cast<std::size_t>(rule)];
  if (finding.count++ > 0) return;
  finding.rule = rule;
  finding.first = now_ps();
  finding.job = board_->host().frames().jobs() - 1;
  finding.access = accesses_;
  finding.what = text();
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
  if (started_ && !listed_ && !end_seen_ && !asks && is_result(offset, bytes)) {
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
  }
}

void DriverRules::judge_start(Picoseconds time, const RegisterBank& bank, bool listed) {
  // An acknowledgement may be lost on its way.
  if (!listed && bank.get(field::kInterruptStatusDone) != 0 && !acknowledged_at_start_) {
    found(DriverRule::start_unacknowledged, [] {
      return std::string("a job was started while INTERRUPT_STATUS.done of an earlier end was set");
    });
  }
  if (started_ && !listed_ && !end_seen_) {
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
  if (listed && !list_lacks_.empty()) {
    found(DriverRule::list_not_set, [&] {
      return fmt::format("the doorbell was rung, and {} was not written since the last reset",
                         list_lacks_);
    });
  }
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
    return fmt::format("the host still waits for a job that was started at {}.{:03} ns and {}",
                       started_at_ / 1000, started_at_ % 1000,
                       job_has_ended() ? "has ended" : "has no end");
  });
}

void DriverRules::forget_job() {
  started_ = false;
  line_blocked_ = false;
  owned_.clear();
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

void DriverRules::unordered(bool read, std::uint64_t address, std::size_t bytes) {
  place_ = started_from_;
  found(DriverRule::missing_barrier, [&] {
    return fmt::format(
        "the board {} {} bytes at {:#x}, which the host has stored to without a "
        "barrier behind it",
        read ? "read" : "wrote", bytes, address);
  });
}

void DriverRules::refused(const std::string& why, bool allowed) {
  place_ = started_from_;
  found(allowed ? DriverRule::stray_dma : DriverRule::no_bus_master, [&] { return why; });
}

// The order is the host's: what it has posted may not have arrived when it goes on.
void DriverRules::asked(const OutsideHost::Access& access) {
  if (look_) places_.push_back(look_());
  if (access.space != OutsideHost::Space::bar || access.command != Command::write) return;
  for (std::size_t i = 0; i < kListRegisters; ++i) {
    const auto reg = static_cast<Register>(static_cast<std::size_t>(Register::dma_list_low) + i);
    const std::optional<std::uint32_t> word = word_for(reg, access.offset, access.data);
    if (!word) continue;
    list_[i] = *word;
    list_set_[i] = true;
  }
  const RegisterBank& bank = board_->accelerator().bank();
  const auto status = word_for(Register::interrupt_status, access.offset, access.data);
  if (status && (*status & field::kInterruptStatusDone.mask()) != 0) {
    acknowledged_ = acknowledged_ || bank.get(field::kInterruptStatusDone) != 0;
  }
  const std::optional<std::uint32_t> command =
      word_for(Register::control, access.offset, access.data);
  if (!command) return;
  acknowledged_at_start_ = std::exchange(acknowledged_, false);
  if ((*command & field::kControlReset.mask()) != 0) {
    list_set_ = {};
  } else if ((*command & field::kControlRunList.mask()) != 0) {
    list_lacks_ = missing_of_list();
    take_memory();
  }
}

// The first of the registers that a list needs and that was not written since the last reset.
std::string_view DriverRules::missing_of_list() const {
  struct Needed {
    Register reg;
    std::string_view name;
  };
  for (const Needed& needed :
       {Needed{Register::dma_list_low, "DMA_LIST_LOW"}, Needed{Register::dma_count, "DMA_COUNT"},
        Needed{Register::dma_record_low, "DMA_RECORD_LOW"}}) {
    if (!list_set_[list_register(needed.reg)]) return needed.name;
  }
  return {};
}

// From the doorbell until the record is written, list, B and record are the board's.
void DriverRules::take_memory() {
  owned_.clear();
  contents_.clear();
  if (board_->memory() == nullptr) return;
  const std::uint32_t counts = list_[list_register(Register::dma_count)];
  const std::uint32_t to_board = counts & 0xffff;
  const std::uint32_t count =
      std::min<std::uint32_t>(to_board + (counts >> 16), DmaEngine::kMaxDescriptors);
  own("the record", address_of(list_[3], list_[4]), 4 * kRecordWords);
  own("the list", address_of(list_[0], list_[1]), count * kDescriptorBytes);
  if (owned_.size() < 2) return;
  const std::size_t list = owned_.back().at;
  for (std::uint32_t i = 0; i < std::min(to_board, count); ++i) {
    const std::span<const std::uint8_t> one =
        std::span(contents_).subspan(list + i * kDescriptorBytes, kDescriptorBytes);
    own("b", address_of(word_at(one, 8), word_at(one, 12)),
        std::min<std::uint32_t>(word_at(one, 4), DmaEngine::kMaxDescriptors * 4096));
  }
}

void DriverRules::own(const char* what, std::uint64_t address, std::size_t bytes) {
  if (bytes == 0) return;
  const std::size_t at = contents_.size();
  contents_.resize(at + bytes);
  if (board_->memory()->copy(address, std::span(contents_).subspan(at))) {
    owned_.push_back({what, address, at, bytes});
  } else {
    contents_.resize(at);  // the board will be refused
  }
}

void DriverRules::to_be_moved(bool read, std::uint64_t address, std::size_t bytes) {
  place_ = started_from_;
  for (const Owned& owned : owned_) {
    if (!overlap(address, bytes, owned.address, owned.bytes)) continue;
    const std::uint64_t first = std::max(address, owned.address);
    const std::uint64_t end = std::min(address + bytes, owned.address + owned.bytes);
    present_.resize(end - first);
    if (!board_->memory()->copy(first, present_)) continue;
    const auto before =
        std::span(contents_).subspan(owned.at + (first - owned.address), end - first);
    if (std::ranges::equal(before, present_)) continue;
    found(DriverRule::owned_memory_touched, [&] {
      return fmt::format("{} at {:#x} changed between the doorbell and the board's {}", owned.what,
                         owned.address, read ? "read" : "write");
    });
    std::ranges::copy(present_, before.begin());
  }
  if (read || owned_.empty()) return;
  // The record ends the list; it may arrive in parts.
  const Owned& record = owned_.front();
  if (overlap(address, bytes, record.address, record.bytes)) owned_.clear();
}

void DriverRules::unmapped(std::uint64_t address, std::uint64_t bytes) {
  // Either ends the board's transfers as well.
  place_ = look_ ? look_() : HostPlace{};
  if (!board_->config().may_master() || board_->host().removed()) return;
  for (const Owned& owned : owned_) {
    if (!overlap(address, bytes, owned.address, owned.bytes)) continue;
    found(DriverRule::owned_memory_unmapped, [&] {
      return fmt::format("{} at {:#x} was unmapped before the board had written the list's record",
                         owned.what, owned.address);
    });
    return;
  }
}

void DriverRules::transferred(const MasterAccess& access) {
  place_ = started_from_;
  if (access.purpose == MasterPurpose::descriptors && access.answered) {
    for (std::size_t at = 0; at + kDescriptorBytes <= access.data.size(); at += kDescriptorBytes) {
      const std::uint32_t control = word_at(access.data, at);
      if (control > 1 && turned(control) <= 1) {
        found(DriverRule::byte_order, [&] {
          return fmt::format(
              "a descriptor at {:#x} begins with {:#x}: its bytes the other way round "
              "are {:#x}",
              access.address + at, control, turned(control));
        });
      }
      const bool to_host = control != 0;
      (to_host ? to_host_ : to_board_) += word_at(access.data, at + 4);
    }
    return;
  }
  if (access.purpose != MasterPurpose::record) return;
  const bool done = (word_at(access.data, 0) & field::kStatusDone.mask()) != 0;
  const RegisterBank& bank = board_->accelerator().bank();
  const auto judge = [&](const char* what, std::uint64_t moved, std::uint64_t whole) {
    if (!done || moved == 0 || moved == whole) return;
    found(DriverRule::list_length, [&] {
      return fmt::format("the list's descriptors move {} bytes of {}, which has {}", moved, what,
                         whole);
    });
  };
  judge("B", to_board_, vector_bytes(bank, field::kFormatRhsBits));
  judge("U", to_host_, vector_bytes(bank, field::kFormatVectorBits));
  to_board_ = to_host_ = 0;
}

}  // namespace hvp::vp
