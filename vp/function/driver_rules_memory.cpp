// What the board moves by itself: the lists that it is told, the memory that it owns meanwhile, and
// its transfers.
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "vp/function/access_words.h"
#include "vp/function/driver_rules.h"

namespace hvp::vp {

namespace {

constexpr std::size_t list_register(Register reg) {
  return static_cast<std::size_t>(reg) - static_cast<std::size_t>(Register::dma_list_low);
}

// The bytes of a vector of the loaded matrix.
std::uint64_t vector_bytes(const RegisterBank& bank, Field bits) {
  return 4 * packed_words(3 * std::size_t{bank.get(field::kNodesCount)}, bank.get(bits),
                          bank.get(field::kPackingMode) != 0);
}

}  // namespace

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
    take_list(false);
  } else if ((*command & field::kControlFetchValues.mask()) != 0) {
    take_list(true);
  }
}

// The first of these registers that was not written since the last reset.
std::optional<Register> DriverRules::missing_of(std::span<const Register> needed) const {
  for (const Register reg : needed) {
    if (!list_set_[list_register(reg)]) return reg;
  }
  return std::nullopt;
}

void DriverRules::take_list(bool of_values) {
  static constexpr std::array kOfJob = {Register::dma_list_low, Register::dma_count,
                                        Register::dma_record_low};
  static constexpr std::array kOfValues = {Register::dma_values_low, Register::dma_values_count};
  const auto value = [this](Register reg) { return list_[list_register(reg)]; };
  list_lacks_ = of_values ? missing_of(kOfValues) : missing_of(kOfJob);
  values_rung_ = of_values;
  owned_.give_back();
  if (board_->memory() == nullptr) return;
  if (of_values) {
    owned_.take_values(*board_->memory(), {address_of(value(Register::dma_values_low),
                                                      value(Register::dma_values_high)),
                                           value(Register::dma_values_count) & 0xffff});
    return;
  }
  const std::uint32_t counts = value(Register::dma_count);
  const std::uint32_t to_board = std::min(counts & 0xffff, DmaEngine::kMaxDescriptors);
  const std::uint32_t to_host = std::min(counts >> 16, DmaEngine::kMaxDescriptors - to_board);
  owned_.take_job(*board_->memory(),
                  {address_of(value(Register::dma_list_low), value(Register::dma_list_high)),
                   to_board, to_host},
                  address_of(value(Register::dma_record_low), value(Register::dma_record_high)));
}

void DriverRules::to_be_moved(bool read, std::uint64_t address, std::size_t bytes) {
  place_ = started_from_;
  const std::optional<OwnedMemory::Part> part =
      owned_.changed(*board_->memory(), read, address, bytes);
  if (!part) return;
  found(DriverRule::owned_memory_touched, [&] {
    return fmt::format("{} at {:#x} changed between the doorbell and the board's {}", part->what,
                       part->address, read ? "read" : "write");
  });
}

void DriverRules::unmapped(std::uint64_t address, std::uint64_t bytes) {
  // Either ends the board's transfers as well.
  place_ = look_ ? look_() : HostPlace{};
  if (!board_->config().may_master() || board_->host().removed()) return;
  if (owned_.is_values() && !values_rung_ &&
      board_->accelerator().bank().get(field::kStatusBusy) == 0) {
    owned_.give_back();
  }
  const std::optional<OwnedMemory::Part> part = owned_.part_in(address, bytes);
  if (!part) return;
  found(DriverRule::owned_memory_unmapped, [&] {
    return fmt::format("{} at {:#x} was unmapped before the board had {}", part->what,
                       part->address,
                       owned_.is_values() ? "brought all values" : "written the list's record");
  });
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
