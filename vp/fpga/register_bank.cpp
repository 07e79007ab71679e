#include "vp/fpga/register_bank.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>

#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::vp {
namespace {

// The bus and the memories are little-endian; copying words is right on such a host only.
static_assert(std::endian::native == std::endian::little);

constexpr std::uint64_t kWordBytes = 4;
constexpr std::uint8_t kNoRegister = 0xff;

// Index into kRegisters by word offset.
constexpr auto kRegisterAt = [] {
  std::array<std::uint8_t, kRegisterBytes / kWordBytes> at{};
  at.fill(kNoRegister);
  for (std::size_t i = 0; i < kRegisters.size(); ++i) {
    at[kRegisters[i].offset / kWordBytes] = static_cast<std::uint8_t>(i);
  }
  return at;
}();

std::optional<std::size_t> register_at(std::uint64_t offset) {
  if (offset >= kRegisterBytes) return std::nullopt;
  const std::uint8_t i = kRegisterAt[offset / kWordBytes];
  if (i == kNoRegister) return std::nullopt;
  return i;
}

std::optional<std::size_t> aperture_at(std::uint64_t offset) {
  for (std::size_t i = 0; i < kApertures.size(); ++i) {
    if (offset >= kApertures[i].offset && offset - kApertures[i].offset < kApertures[i].size) {
      return i;
    }
  }
  return std::nullopt;
}

std::uint32_t load_word(const std::uint8_t* bytes) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes, sizeof word);
  return word;
}

bool misaligned(std::uint64_t offset, std::size_t bytes) {
  return bytes == 0 || offset % kWordBytes != 0 || bytes % kWordBytes != 0;
}

// True if `written` may not go to the register while the board is busy.
bool locked(const RegisterInfo& info, std::uint32_t written) {
  const bool as_a_whole = (info.busy_mask & ~info.pulse_mask) != 0;
  return as_a_whole || (info.busy_mask & written) != 0;
}

std::uint32_t room(std::string_view key, std::uint32_t value, std::uint32_t most) {
  if (value == 0 || value > most) {
    throw InputError(std::string(key),
                     fmt::format("is {}; the register map has room for 1 to {}", value, most));
  }
  return value;
}

}  // namespace

std::string_view name(Access access) {
  switch (access) {
    case Access::ok:
      return "ok";
    case Access::unmapped:
      return "unmapped";
    case Access::misaligned:
      return "misaligned";
    case Access::read_only:
      return "read-only";
    case Access::write_only:
      return "write-only";
    case Access::busy:
      return "locked while busy";
  }
  return "unknown";
}

RegisterBank::RegisterBank(const Capacity& capacity) {
  const auto entries = [](Aperture aperture) {
    return kApertures[index(aperture)].size / static_cast<std::uint32_t>(kWordBytes);
  };
  const std::uint32_t nodes = room("nodes", capacity.nodes, entries(Aperture::b) / 3);
  const std::uint32_t row_blocks =
      room("row_blocks", capacity.row_blocks, entries(Aperture::row) / 9);
  const std::uint32_t blocks = room("blocks", capacity.blocks, entries(Aperture::column));

  memory_[index(Aperture::row)].resize(std::size_t{9} * row_blocks);
  memory_[index(Aperture::b)].resize(std::size_t{3} * nodes);
  memory_[index(Aperture::u)].resize(std::size_t{3} * nodes);
  memory_[index(Aperture::row_begin)].resize(std::size_t{nodes} + 1);
  memory_[index(Aperture::column)].resize(blocks);
  memory_[index(Aperture::value)].resize(std::size_t{9} * blocks);

  for (std::size_t i = 0; i < kRegisters.size(); ++i) reset_value_[i] = kRegisters[i].reset;
  value_ = reset_value_;
  strap(Register::capability_nodes, nodes << field::kCapabilityNodesMaxNodes.low |
                                        row_blocks << field::kCapabilityNodesMaxRowBlocks.low);
  strap(Register::capability_blocks, blocks);
}

AccessResult RegisterBank::check_memory(std::size_t aperture, Command command, std::uint64_t offset,
                                        std::size_t bytes) const {
  const ApertureInfo& info = kApertures[aperture];
  const std::uint64_t implemented = kWordBytes * memory_[aperture].size();
  const std::uint64_t begin = offset - info.offset;
  if (begin >= implemented) return {Access::unmapped, offset};
  if (bytes > implemented - begin) return {Access::unmapped, info.offset + implemented};
  if (command == Command::read && !info.readable) return {Access::write_only, offset};
  if (command == Command::write && !info.writable) return {Access::read_only, offset};
  if (busy() && info.locked_while_busy) return {Access::busy, offset};
  return {Access::ok, offset};
}

AccessResult RegisterBank::check_registers(Command command, std::uint64_t offset, std::size_t bytes,
                                           const std::uint8_t* written) const {
  for (std::size_t done = 0; done < bytes; done += kWordBytes) {
    const std::uint64_t at = offset + done;
    const auto i = register_at(at);
    if (!i) return {Access::unmapped, at};
    const RegisterInfo& info = kRegisters[*i];
    if (command == Command::read) {
      if (info.read_mask == 0) return {Access::write_only, at};
      continue;
    }
    if (info.write_mask == 0) return {Access::read_only, at};
    if (busy() && locked(info, load_word(written + done))) return {Access::busy, at};
  }
  return {Access::ok, offset};
}

AccessResult RegisterBank::read(std::uint64_t offset, std::span<std::uint8_t> data) {
  const auto refuse = [&data](AccessResult outcome) {
    std::fill(data.begin(), data.end(), std::uint8_t{0xff});
    return outcome;
  };
  if (misaligned(offset, data.size())) return refuse({Access::misaligned, offset});

  if (const auto aperture = aperture_at(offset)) {
    const AccessResult outcome = check_memory(*aperture, Command::read, offset, data.size());
    if (!outcome.ok()) return refuse(outcome);
    const std::size_t first = (offset - kApertures[*aperture].offset) / kWordBytes;
    std::memcpy(data.data(), memory_[*aperture].data() + first, data.size());
    return outcome;
  }

  const AccessResult outcome = check_registers(Command::read, offset, data.size(), nullptr);
  if (!outcome.ok()) return refuse(outcome);
  for (std::size_t done = 0; done < data.size(); done += kWordBytes) {
    const std::size_t i = *register_at(offset + done);
    const std::uint32_t word = value_[i] & kRegisters[i].read_mask;
    std::memcpy(data.data() + done, &word, sizeof word);
  }
  return outcome;
}

AccessResult RegisterBank::write(std::uint64_t offset, std::span<const std::uint8_t> data) {
  if (misaligned(offset, data.size())) return {Access::misaligned, offset};

  if (const auto aperture = aperture_at(offset)) {
    const AccessResult outcome = check_memory(*aperture, Command::write, offset, data.size());
    if (!outcome.ok()) return outcome;
    const std::size_t first = (offset - kApertures[*aperture].offset) / kWordBytes;
    std::memcpy(memory_[*aperture].data() + first, data.data(), data.size());
    if (on_memory_write_[*aperture]) on_memory_write_[*aperture]();
    return outcome;
  }

  const AccessResult outcome = check_registers(Command::write, offset, data.size(), data.data());
  if (!outcome.ok()) return outcome;
  for (std::size_t done = 0; done < data.size(); done += kWordBytes) {
    const std::size_t i = *register_at(offset + done);
    const RegisterInfo& info = kRegisters[i];
    const std::uint32_t written = load_word(data.data() + done);
    const std::uint32_t stored = info.write_mask & ~info.write_one_to_clear_mask & ~info.pulse_mask;
    const std::uint32_t before = value_[i];
    value_[i] = (before & ~stored) | (written & stored);
    value_[i] &= ~(written & info.write_one_to_clear_mask);
    if (on_write_[i]) on_write_[i](written, before);
  }
  return outcome;
}

std::string RegisterBank::name_at(std::uint64_t offset) const {
  if (const auto aperture = aperture_at(offset)) {
    const ApertureInfo& info = kApertures[*aperture];
    return fmt::format("{}[+0x{:x}]", info.name, offset - info.offset);
  }
  const auto i = register_at(offset);
  if (!i) return fmt::format("0x{:x}", offset);
  const std::uint64_t byte = offset % kWordBytes;
  if (byte != 0) return fmt::format("{}[+{}]", kRegisters[*i].name, byte);
  return std::string(kRegisters[*i].name);
}

std::string RegisterBank::describe(const AccessResult& outcome, Command command) const {
  const std::uint64_t offset = outcome.offset;
  const std::string_view verb = command == Command::read ? "read of" : "write to";
  std::string reason(name(outcome.access));
  if (outcome.access == Access::unmapped) {
    const auto aperture = aperture_at(offset);
    reason = aperture ? fmt::format("beyond the {} bytes that this board implements",
                                    kWordBytes * memory_[*aperture].size())
                      : "no register there";
  }
  const std::string register_name = name_at(offset);
  if (register_at(offset) || aperture_at(offset)) {
    return fmt::format("{} {} (0x{:02x}): {}", verb, register_name, offset, reason);
  }
  return fmt::format("{} {}: {}", verb, register_name, reason);
}

void RegisterBank::set(Field field, std::uint32_t value) {
  std::uint32_t& word = value_[index(field.reg)];
  word = (word & ~field.mask()) | (value << field.low & field.mask());
}

void RegisterBank::strap(Register reg, std::uint32_t value) {
  reset_value_[index(reg)] = value;
  value_[index(reg)] = value;
}

void RegisterBank::reset() {
  value_ = reset_value_;
  for (auto& words : memory_) std::fill(words.begin(), words.end(), 0);
}

}  // namespace hvp::vp
