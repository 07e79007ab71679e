#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "models/link/pcie.h"
#include "vp/fault/fault_plan.h"
#include "vp/function/error_reporting.h"
#include "vp/function/express_capability.h"
#include "vp/function/message_table.h"

namespace hvp::vp {

// The capabilities of the board's function beyond its BAR.
struct FunctionSettings {
  std::uint32_t bar_bytes = 0;  // a power of two
  bool messages = false;        // the function has the capability MSI
  bool wide_bar = false;        // the BAR's address has 64 bits, in two words
  // The link that a capability of PCI Express describes; empty: there is none.
  std::optional<link::Pcie> express = {};
  bool message_table = false;  // messages by MSI-X, in the place of MSI
};

// The configuration space of the board's PCI function as software sees it, without a clock: a
// header of type 0 (PCI 3.0 §6.1), power management (PCI Power Management 1.2 §3.2), one message
// with 64 bits of address and a mask (PCI 3.0 §6.8.1) or a table of one vector (§6.8.2), a reset of
// the function (PCI Advanced Features ECN of 2006, or the capability of PCI Express), and where
// obey() was called a capability of the vendor's by which software asks something of the model.
//
// An access has 1, 2, 4 or 8 bytes at a multiple of its size. Any other access, and one beyond the
// space's end, reads all ones and writes nothing, as if no function answered.
class ConfigSpace {
 public:
  static constexpr std::size_t kBytes = 256;
  static constexpr std::size_t kExpressBytes = 4096;  // of a function on PCI Express
  static constexpr std::size_t kPowerAt = 0x40;
  static constexpr std::size_t kMessageAt = 0x50;
  static constexpr std::size_t kFeaturesAt = 0x70;  // without a capability of PCI Express
  static constexpr std::size_t kExpressAt = 0x80;
  static constexpr std::size_t kMessageTableAt = 0xc0;  // the capability MSI-X
  static constexpr std::size_t kMessageTableBar = 2;
  static constexpr std::size_t kModelAt = 0xd0;
  static constexpr std::size_t kLongestCommand = 255;

  struct Message {
    std::uint64_t address;
    std::uint32_t data;  // of MSI 16 bits
  };
  // Errors that the function notes in its status register (PCI 3.0 §6.2.3).
  enum class Error : std::uint16_t { master_abort = 1U << 13U, parity = 1U << 15U };

  // Throws std::invalid_argument unless the BAR's size is a power of two of at least 16 bytes.
  explicit ConfigSpace(const FunctionSettings& settings);

  std::size_t bytes() const { return value_.size(); }
  void read(std::uint64_t offset, std::span<std::uint8_t> data) const;
  void write(std::uint64_t offset, std::span<const std::uint8_t> data);
  // The BAR of MSI-X; 0: there is none.
  std::size_t table_bytes() const { return table_ ? MessageTable::kBytes : 0; }
  // Accesses it, where it is there and the function answers; else a read gives all ones.
  void read_table(std::uint64_t offset, std::span<std::uint8_t> data) const;
  void write_table(std::uint64_t offset, std::span<const std::uint8_t> data);
  // Sets the state after power-on.
  void reset();
  // The byte that software writes to reset the function, and where.
  struct ResetByte {
    std::uint64_t offset;
    std::uint8_t value;
  };
  ResetByte reset_byte() const;

  // `reset` is called when software resets the function, by the capability or by leaving D3hot; the
  // configuration space has been reset before. `change` is called after any other change of the
  // state below.
  void on_reset(std::function<void()> reset) { on_reset_ = std::move(reset); }
  void on_change(std::function<void()> change) { on_change_ = std::move(change); }

  // Adds the vendor's capability, to be called before the first access: its words of four
  // characters make a command, up to one with a zero, and `answer` returns what is read then. No
  // real board has it.
  using Answer = std::function<std::string(std::string_view command)>;
  void obey(Answer answer);

  // True if accesses to the BAR are answered: COMMAND's memory space, in D0.
  bool decodes() const;
  // True if the function may be bus master: COMMAND's bus master, in D0.
  bool may_master() const;
  // True if the function may raise INTA#: MSI is off, and COMMAND does not disable the line.
  bool may_raise_line() const;
  bool messages_enabled() const;
  bool message_masked() const;
  bool in_d0() const;
  Message message() const;
  std::uint64_t bar() const;

  // Sets STATUS' interrupt bit: the state of the interrupt, whatever COMMAND says.
  void show_line(bool up);
  void show_pending(bool pending);
  void note(Error error);
  // Notes an error of PCI Express, where the function has the capability. True if it reports it to
  // the root port (PCIe 5.0 §6.2.6): it is not masked, and software wants reports.
  bool note(ExpressError error);
  // The errors noted since software cleared them, and whether an access touches that register.
  BusErrors errors() const;
  static bool reaches_errors(std::uint64_t offset, std::size_t bytes);

 private:
  std::uint16_t half(std::size_t at) const;
  std::uint32_t word(std::size_t at) const;
  void put(std::size_t at, std::uint32_t value, std::size_t bytes);
  void allow(std::size_t at, std::uint32_t mask, std::size_t bytes);
  void add(const ConfigRegister& one);
  void take_command(std::span<const std::uint8_t> characters);
  void show_answer();

  bool has_messages_;
  std::optional<MessageTable> table_;  // of MSI-X
  bool wide_bar_;
  bool express_;
  std::vector<std::uint8_t> value_;
  std::vector<std::uint8_t> initial_;
  std::vector<std::uint8_t> writable_;
  std::vector<std::uint8_t> cleared_by_one_;
  std::vector<bool> sticky_;
  std::function<void()> on_reset_;
  std::function<void()> on_change_;
  Answer answer_;
  std::string command_;  // as far as it has come
  std::string answered_;
};

}  // namespace hvp::vp
