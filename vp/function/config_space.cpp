#include "vp/function/config_space.h"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <string>

#include "driver/hvp_pci.h"
#include "vp/fpga/register_table.h"

namespace hvp::vp {

namespace {

// Places of a header of type 0 (PCI 3.0 figure 6-1).
constexpr std::size_t kVendor = 0x00;
constexpr std::size_t kDevice = 0x02;
constexpr std::size_t kCommand = 0x04;
constexpr std::size_t kStatus = 0x06;
constexpr std::size_t kRevision = 0x08;
constexpr std::size_t kClass = 0x09;
constexpr std::size_t kCacheLine = 0x0c;
constexpr std::size_t kLatencyTimer = 0x0d;
constexpr std::size_t kBar0 = 0x10;
constexpr std::uint32_t kWideMemory = 2U << 1U;  // the address goes on in the next word
constexpr std::size_t kSubsystemVendor = 0x2c;
constexpr std::size_t kSubsystem = 0x2e;
constexpr std::size_t kCapabilities = 0x34;
constexpr std::size_t kInterruptLine = 0x3c;
constexpr std::size_t kInterruptPin = 0x3d;

// COMMAND: memory space, bus master, parity error response, SERR# enable, interrupt disable.
constexpr std::uint16_t kMemorySpace = 1U << 1U;
constexpr std::uint16_t kBusMaster = 1U << 2U;
constexpr std::uint16_t kInterruptDisable = 1U << 10U;
constexpr std::uint16_t kSerrEnable = 1U << 8U;
constexpr std::uint16_t kCommandBits =
    kMemorySpace | kBusMaster | 1U << 6U | kSerrEnable | kInterruptDisable;
// STATUS: INTA# is asked for; there is a list of capabilities; errors, cleared by a one.
constexpr std::uint16_t kInterruptState = 1U << 3U;
constexpr std::uint16_t kHasCapabilities = 1U << 4U;
constexpr std::uint16_t kErrors = 0xf900;

constexpr std::uint8_t kPowerId = 0x01;
constexpr std::uint8_t kMessageId = 0x05;
constexpr std::uint8_t kFeaturesId = 0x13;
constexpr std::uint8_t kMessageTableId = 0x11;
constexpr std::uint8_t kVendorId = 0x09;

// Power management: version 3; D1 and D2 are left out, and a function that leaves D3hot has been
// reset.
constexpr std::size_t kPowerState = ConfigSpace::kPowerAt + 4;
constexpr std::uint16_t kPowerStateBits = 3;
constexpr std::uint16_t kD3Hot = 3;

// One message: 64 bits of address, a mask. Control, address, data, mask and pending.
constexpr std::size_t kMessageControl = ConfigSpace::kMessageAt + 2;
constexpr std::size_t kMessageLow = ConfigSpace::kMessageAt + 4;
constexpr std::size_t kMessageHigh = ConfigSpace::kMessageAt + 8;
constexpr std::size_t kMessageData = ConfigSpace::kMessageAt + 12;
constexpr std::size_t kMessageMask = ConfigSpace::kMessageAt + 16;
constexpr std::size_t kMessagePending = ConfigSpace::kMessageAt + 20;
constexpr std::uint16_t kMessageEnable = 1;
constexpr std::uint16_t kMessageFormat = 1U << 7U | 1U << 8U;

// MSI-X: one vector; the table and the pending bits, each with the number of its BAR.
constexpr std::size_t kBar2 = kBar0 + 4 * ConfigSpace::kMessageTableBar;
constexpr std::size_t kTableControl = ConfigSpace::kMessageTableAt + 2;
constexpr std::uint16_t kTableMaskAll = 1U << 14U;
constexpr std::uint16_t kTableEnable = 1U << 15U;

constexpr std::size_t kFeaturesControl = ConfigSpace::kFeaturesAt + 4;
constexpr std::uint8_t kFeatures = 3;  // transactions pending, and the reset
// The upper byte of PCI Express' Device Control.
constexpr std::size_t kExpressControl = ConfigSpace::kExpressAt + kExpressControlAt + 1;
constexpr std::uint8_t kExpressReset = 1U << 7U;

// The vendor's: identity, next, length, version; the command; which word of the answer; that word.
constexpr std::size_t kModelBytes = 16;
constexpr std::size_t kModelCommand = ConfigSpace::kModelAt + 4;
constexpr std::size_t kModelPlace = ConfigSpace::kModelAt + 8;
constexpr std::size_t kModelAnswer = ConfigSpace::kModelAt + 12;

bool defined(std::uint64_t offset, std::size_t bytes, std::size_t all) {
  return bytes <= 8 && std::has_single_bit(bytes) && offset % bytes == 0 && offset < all;
}

}  // namespace

ConfigSpace::ConfigSpace(const FunctionSettings& settings)
    : has_messages_(settings.messages && !settings.message_table),
      wide_bar_(settings.wide_bar),
      express_(settings.express.has_value()),
      value_(express_ ? kExpressBytes : kBytes),
      writable_(value_.size()),
      cleared_by_one_(value_.size()),
      sticky_(value_.size()) {
  if (settings.bar_bytes < 16 || !std::has_single_bit(settings.bar_bytes)) {
    throw std::invalid_argument("a BAR of " + std::to_string(settings.bar_bytes) +
                                " bytes: expected a power of two, at least 16");
  }
  put(kVendor, HVP_PCI_VENDOR_ID, 2);
  put(kDevice, HVP_PCI_DEVICE_ID, 2);
  allow(kCommand, kCommandBits, 2);
  put(kStatus, kHasCapabilities, 2);
  const std::uint32_t version = kRegisters[static_cast<std::size_t>(Register::version)].reset;
  put(kRevision, version >> 16U, 1);
  put(kClass, HVP_PCI_CLASS, 3);
  allow(kCacheLine, 0xff, 1);
  allow(kLatencyTimer, 0xff, 1);
  allow(kBar0, ~(settings.bar_bytes - 1U), 4);
  if (wide_bar_) {
    put(kBar0, kWideMemory, 4);
    allow(kBar0 + 4, 0xffff'ffff, 4);
  }
  put(kSubsystemVendor, HVP_PCI_VENDOR_ID, 2);
  put(kSubsystem, HVP_PCI_DEVICE_ID, 2);
  allow(kInterruptLine, 0xff, 1);
  put(kInterruptPin, 1, 1);

  put(kCapabilities, kPowerAt, 1);
  put(kPowerAt, kPowerId, 1);
  const std::size_t for_reset = express_ ? kExpressAt : kFeaturesAt;
  const std::size_t for_messages = settings.message_table ? kMessageTableAt : kMessageAt;
  put(kPowerAt + 1, static_cast<std::uint32_t>(settings.messages ? for_messages : for_reset), 1);
  put(kPowerAt + 2, 3, 2);
  allow(kPowerState, kPowerStateBits, 2);
  if (has_messages_) {
    put(kMessageAt, kMessageId, 1);
    put(kMessageAt + 1, static_cast<std::uint32_t>(for_reset), 1);
    put(kMessageControl, kMessageFormat, 2);
    allow(kMessageControl, kMessageEnable, 2);
    allow(kMessageLow, 0xffff'fffc, 4);
    allow(kMessageHigh, 0xffff'ffff, 4);
    allow(kMessageData, 0xffff, 2);
    allow(kMessageMask, 1, 4);
  }
  if (settings.messages && settings.message_table) {
    table_.emplace();
    put(kMessageTableAt, kMessageTableId, 1);
    put(kMessageTableAt + 1, static_cast<std::uint32_t>(for_reset), 1);
    allow(kTableControl, kTableEnable | kTableMaskAll, 2);
    put(kMessageTableAt + 4, kMessageTableBar, 4);
    put(kMessageTableAt + 8, MessageTable::kPendingAt | kMessageTableBar, 4);
    allow(kBar2, ~(static_cast<std::uint32_t>(MessageTable::kBytes) - 1U), 4);
  }
  if (express_) {
    for (const ConfigRegister& one : express_capability(*settings.express, kExpressAt, 0)) add(one);
    for (const ConfigRegister& one : error_capability()) add(one);
  } else {
    put(kFeaturesAt, kFeaturesId, 1);
    put(kFeaturesAt + 2, 6, 1);
    put(kFeaturesAt + 3, kFeatures, 1);
  }

  for (std::size_t i = 0; i < 2; ++i) {
    cleared_by_one_[kStatus + i] = static_cast<std::uint8_t>(kErrors >> 8 * i);
  }
  initial_ = value_;
}

void ConfigSpace::add(const ConfigRegister& one) {
  put(one.at, one.value, one.bytes);
  allow(one.at, one.writable, one.bytes);
  for (std::size_t i = 0; i < one.bytes; ++i) {
    cleared_by_one_.at(one.at + i) = static_cast<std::uint8_t>(one.cleared_by_one >> 8 * i);
    sticky_.at(one.at + i) = one.sticky;
  }
}

ConfigSpace::ResetByte ConfigSpace::reset_byte() const {
  if (express_) return {kExpressControl, kExpressReset};
  return {kFeaturesControl, 1};
}

void ConfigSpace::obey(Answer answer) {
  answer_ = std::move(answer);
  put((express_ ? kExpressAt : kFeaturesAt) + 1, kModelAt, 1);
  put(kModelAt, kVendorId, 1);
  put(kModelAt + 2, kModelBytes, 1);
  put(kModelAt + 3, 1, 1);
  allow(kModelPlace, 0xff, 4);
  initial_ = value_;
}

void ConfigSpace::take_command(std::span<const std::uint8_t> characters) {
  for (const std::uint8_t character : characters) {
    if (character != 0) {
      command_.push_back(static_cast<char>(character));
      continue;
    }
    answered_ = command_.size() > kLongestCommand
                    ? "expected at most " + std::to_string(kLongestCommand) + " characters"
                    : answer_(command_);
    command_.clear();
    put(kModelPlace, 0, 4);
    break;
  }
  // A command that never ends takes no memory.
  if (command_.size() > kLongestCommand) command_.resize(kLongestCommand + 1);
}

void ConfigSpace::show_answer() {
  const std::size_t begin = std::size_t{4} * value_.at(kModelPlace);
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t at = begin + i;
    const char character = at < answered_.size() ? answered_[at] : '\0';
    put(kModelAnswer + i, static_cast<std::uint8_t>(character), 1);
  }
}

void ConfigSpace::put(std::size_t at, std::uint32_t value, std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; ++i) {
    value_.at(at + i) = static_cast<std::uint8_t>(value >> 8 * i);
  }
}

void ConfigSpace::allow(std::size_t at, std::uint32_t mask, std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; ++i) {
    writable_.at(at + i) = static_cast<std::uint8_t>(mask >> 8 * i);
  }
}

BusErrors ConfigSpace::errors() const {
  const std::uint32_t status = half(kStatus);
  return {.master_abort = (status & static_cast<std::uint32_t>(Error::master_abort)) != 0,
          .parity = (status & static_cast<std::uint32_t>(Error::parity)) != 0};
}

bool ConfigSpace::reaches_errors(std::uint64_t offset, std::size_t bytes) {
  return offset < kStatus + 2 && offset + bytes > kStatus + 1;
}

std::uint16_t ConfigSpace::half(std::size_t at) const {
  return static_cast<std::uint16_t>(value_.at(at) | value_.at(at + 1) << 8);
}

std::uint32_t ConfigSpace::word(std::size_t at) const {
  return static_cast<std::uint32_t>(half(at)) | static_cast<std::uint32_t>(half(at + 2)) << 16U;
}

void ConfigSpace::read(std::uint64_t offset, std::span<std::uint8_t> data) const {
  if (!defined(offset, data.size(), bytes())) {
    std::ranges::fill(data, std::uint8_t{0xff});
    return;
  }
  std::copy_n(value_.begin() + static_cast<std::ptrdiff_t>(offset), data.size(), data.begin());
}

void ConfigSpace::write(std::uint64_t offset, std::span<const std::uint8_t> data) {
  if (!defined(offset, data.size(), bytes())) return;
  const ResetByte to_reset = reset_byte();
  const bool was_in_d0 = in_d0();
  bool asks_for_reset = false;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const std::size_t at = offset + i;
    const std::uint8_t given = data[i];
    std::uint8_t& byte = value_.at(at);
    if (at == kPowerState) {
      // A state that the function has not is ignored (PCI Power Management 1.2 §3.2.4).
      const std::uint8_t state = given & kPowerStateBits;
      if (state == 0 || state == kD3Hot) byte = state;
      continue;
    }
    if (at == to_reset.offset && (given & to_reset.value) != 0) asks_for_reset = true;
    byte = static_cast<std::uint8_t>((byte & ~writable_.at(at)) | (given & writable_.at(at)));
    byte = static_cast<std::uint8_t>(byte & ~(given & cleared_by_one_.at(at)));
  }
  if (answer_) {
    if (offset == kModelCommand && data.size() == 4) take_command(data);
    show_answer();
  }
  if (asks_for_reset || (!was_in_d0 && in_d0())) {
    reset();
    if (on_reset_) on_reset_();
    return;
  }
  if (on_change_) on_change_();
}

void ConfigSpace::read_table(std::uint64_t offset, std::span<std::uint8_t> data) const {
  if (table_ && decodes()) {
    table_->read(offset, data);
  } else {
    std::ranges::fill(data, std::uint8_t{0xff});
  }
}

void ConfigSpace::write_table(std::uint64_t offset, std::span<const std::uint8_t> data) {
  if (!table_ || !decodes()) return;
  table_->write(offset, data);
  if (on_change_) on_change_();
}

void ConfigSpace::reset() {
  for (std::size_t at = 0; at < value_.size(); ++at) {
    if (!sticky_[at]) value_[at] = initial_[at];
  }
  if (table_) table_->reset();
  command_.clear();
  answered_.clear();
}

bool ConfigSpace::in_d0() const { return (half(kPowerState) & kPowerStateBits) == 0; }

bool ConfigSpace::decodes() const { return in_d0() && (half(kCommand) & kMemorySpace) != 0; }

bool ConfigSpace::may_master() const { return in_d0() && (half(kCommand) & kBusMaster) != 0; }

bool ConfigSpace::may_raise_line() const {
  return in_d0() && !messages_enabled() && (half(kCommand) & kInterruptDisable) == 0;
}

bool ConfigSpace::messages_enabled() const {
  if (table_) return (half(kTableControl) & kTableEnable) != 0;
  return has_messages_ && (half(kMessageControl) & kMessageEnable) != 0;
}

bool ConfigSpace::message_masked() const {
  if (table_) return table_->masked() || (half(kTableControl) & kTableMaskAll) != 0;
  return (word(kMessageMask) & 1U) != 0;
}

ConfigSpace::Message ConfigSpace::message() const {
  if (table_) return {table_->address(), table_->data()};
  return {static_cast<std::uint64_t>(word(kMessageHigh)) << 32U | word(kMessageLow),
          half(kMessageData)};
}

std::uint64_t ConfigSpace::bar() const {
  if (!wide_bar_) return word(kBar0);
  return static_cast<std::uint64_t>(word(kBar0 + 4)) << 32U | (word(kBar0) & ~kWideMemory);
}

void ConfigSpace::show_line(bool up) {
  const std::uint16_t status = half(kStatus);
  put(kStatus, up ? status | kInterruptState : status & ~kInterruptState, 2);
}

void ConfigSpace::show_pending(bool pending) {
  if (table_) table_->show_pending(pending);
  if (has_messages_) put(kMessagePending, pending ? 1 : 0, 4);
}

bool ConfigSpace::note(ExpressError error) {
  if (!express_) return false;
  constexpr std::size_t kDeviceControl = kExpressAt + kExpressControlAt;
  constexpr std::size_t kDeviceStatus = kExpressAt + kExpressStatusAt;
  const bool corrected = error == ExpressError::bad_packet;
  const std::uint32_t bit = corrected ? kBadPacket : kPoisonedPacket;
  const std::size_t status = corrected ? kCorrectableAt : kUncorrectableAt;
  const std::size_t mask = corrected ? kCorrectableMaskAt : kUncorrectableMaskAt;
  const std::uint16_t kind = corrected                        ? kCorrectableError
                             : (word(kSeverityAt) & bit) != 0 ? kFatalError
                                                              : kNonFatalError;
  put(status, word(status) | bit, 4);
  put(kDeviceStatus, half(kDeviceStatus) | static_cast<std::uint32_t>(kind), 2);
  if (!corrected) note(Error::parity);
  const bool wanted =
      (half(kDeviceControl) & kind) != 0 || (!corrected && (half(kCommand) & kSerrEnable) != 0);
  return wanted && (word(mask) & bit) == 0;
}

void ConfigSpace::note(Error error) {
  put(kStatus, half(kStatus) | static_cast<std::uint32_t>(error), 2);
}

}  // namespace hvp::vp
