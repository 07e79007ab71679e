#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <systemc>
#include <vector>

#include <tlm_utils/simple_initiator_socket.h>

#include "vp/bus/bus_settings.h"
#include "vp/fault/fault_plan.h"
#include "vp/fpga/board_registers.h"
#include "vp/fpga/master_access.h"
#include "vp/fpga/register_bank.h"
#include "vp/frame/frame_tag.h"
#include "vp/frame/ledger.h"

namespace hvp::vp {

// The numbers of bytes that a list has moved.
struct ListBytes {
  std::uint32_t to_board = 0;
  std::uint32_t to_host = 0;
};

inline constexpr std::size_t kDescriptorWords = 8;
inline constexpr std::size_t kDescriptorBytes = 4 * kDescriptorWords;
inline constexpr std::size_t kRecordWords = 8;
using CompletionRecord = std::array<std::uint32_t, kRecordWords>;

// An address of the host's memory in two registers, or in two words of a descriptor.
constexpr std::uint64_t address_of(std::uint32_t low, std::uint32_t high) {
  return std::uint64_t{high} << 32U | low;
}

// The details of dma_failed that are not the index of a descriptor.
inline constexpr std::uint32_t kListFailed = 0xffff'fffe;
inline constexpr std::uint32_t kRecordFailed = 0xffff'ffff;

// The board around the engine, as the engine calls it.
class ListOwner {
 public:
  virtual ~ListOwner() = default;
  // B has arrived: starts the solve for the tag, whose end DmaEngine::solved() reports.
  virtual void solve_listed(const Tag& tag) = 0;
  virtual CompletionRecord completion(const BoardError& error, const ListBytes& moved) const = 0;
  // The list has ended and its record is written, or could not be written. It is whole if it moved
  // as many bytes as its descriptors say.
  virtual void list_ended(const BoardError& error, bool whole, const Tag& tag) = 0;
  // VALUE has been brought whole, or not.
  virtual void values_fetched(const BoardError& error, const Tag& tag) = 0;
};

// The board's bus master: works through a list of descriptors (CONTROL.run_list in
// docs/registers.md), or of those that bring VALUE, and sends interrupts as messages. It is one
// process with one transaction at a time; every request goes out through to_memory with the job's
// tag, so that a frame's critical path runs through it. It exists only if a scenario asks for one
// of the two.
class DmaEngine : public sc_core::sc_module {
 public:
  // The largest number of descriptors in a list: 32 bytes each, 8 KiB of the board's memory.
  static constexpr std::uint32_t kMaxDescriptors = 256;

  // `untimed` leaves out the engine's own latency. Keeps references.
  DmaEngine(const sc_core::sc_module_name& name, const MasterSettings& settings, bool untimed,
            RegisterBank& bank, ListOwner& owner, Ledger& ledger);
  ~DmaEngine() override;

  // If it is unbound, every transfer fails and messages are lost.
  tlm_utils::simple_initiator_socket_optional<DmaEngine> to_memory;

  // Reports every transaction at its begin and at its end, from now on.
  void observe(MasterObserver& observer) { observers_.push_back(&observer); }
  // Makes the engine's faults happen as planned, from now on. `link` is the board's; null on PCI.
  void inject(FaultPlan& plan, const link::Pcie* link) {
    faults_ = &plan;
    link_ = link;
  }

  bool has_lists() const { return settings_.dma.has_value(); }
  bool sends_messages() const { return settings_.messages; }

  // The doorbell, when the registers DMA_* are set. The frame is kept open until the list has
  // ended.
  void ring(const Tag& tag);
  // Likewise, when the registers DMA_VALUES_* are set.
  void fetch_values(const Tag& tag);
  // The solve has ended, and its span is the tag's newest.
  void solved(const Tag& tag, const BoardError& error);
  // Sends an interrupt as soon as the current transaction has ended.
  void send_message(const Tag& tag);
  // Aborts the list and pending messages. A current transaction ends on the bus, without effect
  // here.
  void abort();

  std::int64_t lists() const { return lists_; }

 private:
  struct Descriptor {
    std::uint32_t bytes;
    std::uint64_t address;
    std::uint32_t offset;
  };
  enum class Way { to_board, to_host, values };

  void run();
  void run_list();
  void run_values();
  void post_message();
  void be_late();
  std::uint32_t missing(std::uint32_t bytes);
  void let_latency_pass(Picoseconds since);
  std::uint64_t list_address() const;
  BoardError fetch(std::uint64_t list, std::uint32_t first, std::uint32_t count);
  BoardError move(Way way, std::uint32_t first, std::uint32_t count);
  BoardError move_values(std::uint32_t count);
  bool move_values_segment(const Descriptor& descriptor);
  bool survive_faults(std::span<std::uint8_t> data);
  void come_again(const Fault& fault, std::size_t bytes);
  static Aperture aperture_of(Way way);
  std::uint8_t* on_board(Way way, std::uint32_t offset);
  bool move_segment(Way way, const Descriptor& descriptor);
  std::optional<Descriptor> parse(Way way, std::uint32_t place) const;
  bool write_record(const BoardError& error);
  void hold(Tag& held, const Tag& tag);
  void let_go(Tag& held);
  bool transport(MasterPurpose purpose, std::uint64_t address, std::span<std::uint8_t> data,
                 Tag& tag, std::optional<Phase> phase = {});

  MasterSettings settings_;
  Picoseconds latency_;
  RegisterBank& bank_;
  ListOwner& owner_;
  Ledger& ledger_;
  FaultPlan* faults_ = nullptr;
  const link::Pcie* link_ = nullptr;
  std::vector<MasterObserver*> observers_;

  sc_core::sc_event work_;
  bool rung_ = false;
  bool rung_for_values_ = false;
  bool solved_ = false;
  bool message_ = false;
  std::uint64_t generation_ = 0;  // number of aborts
  Picoseconds rung_at_ = 0;
  Picoseconds solved_at_ = 0;
  Picoseconds message_at_ = 0;
  BoardError solve_error_;
  Tag rung_tag_;     // the waiting list's
  Tag tag_;          // the current list's
  Tag message_tag_;  // the waiting message's
  Tag posted_tag_;   // the message under way's
  ListBytes moved_;
  bool whole_ = true;  // no segment was cut short
  std::int64_t lists_ = 0;

  tlm::tlm_generic_payload payload_;
  FrameTag extension_;
  std::vector<std::uint32_t> descriptors_;  // the current list's, by index; of values, by turns
  std::vector<std::uint8_t> segment_;       // as long as the longest of B or U, or of values
};

}  // namespace hvp::vp
