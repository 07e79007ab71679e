#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "app/linux/calendar.h"
#include "app/linux/dma_check.h"
#include "app/linux/guest_memory.h"
#include "app/linux/pci_messages.h"
#include "app/linux/recent_accesses.h"
#include "app/linux/stream.h"
#include "app/linux/vhost_user.h"
#include "app/linux/virtqueue.h"
#include "vp/bus/host_memory.h"
#include "vp/bus/weak_memory.h"
#include "vp/function/outside_host.h"

namespace hvp::guest {

// The board's PCI function as a virtio device of the guest. The guest's accesses become those of
// the outside host, the board can read and write the guest's memory, and interrupts become
// messages.
//
// Everything happens while the guest waits for its next event or for our answer, so that the result
// does not depend on the speed of either program.
//
// A write to the BAR is answered at once and later made on the bus in its turn, as long as no more
// than kMostPosted writes are pending. Every other access is answered at its end: simulated time
// goes on while the guest waits in it. If one of the guest's timers is due before that, the guest
// polls for the answer every microsecond (virt-pci.c). Accesses to the configuration space keep
// their order and take no time of their own.
class BoardDevice : public vp::InterruptListener {
 public:
  static constexpr std::size_t kMostPosted = 64;

  struct Counts {
    std::int64_t reads = 0;       // of the BAR
    std::int64_t writes = 0;      // of the BAR
    std::int64_t polled = 0;      // reads that a timer interrupted
    std::int64_t interrupts = 0;  // interrupts of which the guest was told
    bool overrun = false;         // more posted writes than its ring has entries
  };

  // Who is told what the guest's driver maps; null: nobody asks for it.
  struct Mappings {
    DmaCheck* check = nullptr;
    vp::WeakMemory* order = nullptr;
  };

  // Keeps references. `memory` is null if the board is no bus master.
  BoardDevice(vp::OutsideHost& host, vp::HostMemory* memory, const Mappings& told,
              Calendar& calendar, Stream stream);
  ~BoardDevice() override;

  int number() const { return stream_.number(); }
  // Receives and answers one vhost-user message.
  void serve();
  // Returns finished accesses and reports interrupts to a waiting guest. True if the guest was told
  // anything.
  bool settle();
  // Completes finished accesses and begins the next ones, after simulated time has advanced.
  void advance();
  // Returns the simulated time at which settle() will have something to report in any case; none:
  // no such time is known.
  std::optional<vp::Picoseconds> due() const;
  const Counts& counts() const { return counts_; }
  // True if the kernel tells what Mappings::order needs.
  bool tells_of_order() const { return told_.order != nullptr; }
  const RecentAccesses& recent() const { return recent_; }

  // InterruptListener
  void message(const vp::ConfigSpace::Message& message) override;
  void line(bool up) override;

 private:
  enum Ring : std::uint8_t { kCommands, kInterrupts, kRings };

  struct Operation {
    Virtqueue::Chain chain;
    pci::Command command;
    std::uint64_t number = 0;  // among the recent ones
    bool begun = false;
    bool ended = false;
  };

  std::uint64_t answer(const vhost::Header& header, std::span<const std::uint8_t> payload,
                       std::vector<Descriptor>& descriptors);
  void accept(std::uint64_t features);
  void take(const vhost::Translation& message) const;
  void share_memory(std::span<const std::uint8_t> payload, std::vector<Descriptor>& descriptors);
  void unshare_memory();
  bool run_until(vp::Picoseconds time);
  Virtqueue& ring(std::uint32_t number);
  void kicked(std::uint32_t number);
  void take_commands();
  void hold();
  void begin();
  void finish();
  bool awaits_an_answer() const;
  void give_back();
  bool tell();
  void call(std::uint32_t number);

  vp::OutsideHost& host_;
  vp::HostMemory* memory_;
  Mappings told_;
  Calendar& calendar_;
  Stream stream_;
  Stream back_channel_;
  GuestMemory guest_memory_;
  std::vector<MappedFile> mappings_;
  Virtqueue rings_[kRings];
  std::deque<Operation> operations_;    // in order; their addresses are stable
  std::vector<std::uint16_t> written_;  // heads of finished writes that are not yet returned
  vp::Picoseconds stalled_for_ = 0;     // behind the accesses that were taken last
  std::uint32_t unreclaimed_ = 0;       // entries that the guest cannot have reclaimed yet
  std::deque<pci::Interrupt> untold_;
  bool line_up_ = false;
  bool line_told_ = false;
  vp::Picoseconds line_again_ = 0;  // the line is not reported again before this time
  Counts counts_;
  RecentAccesses recent_;
};

}  // namespace hvp::guest
