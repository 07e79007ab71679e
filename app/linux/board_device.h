#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "app/linux/calendar.h"
#include "app/linux/guest_memory.h"
#include "app/linux/mapped_file.h"
#include "app/linux/pci_messages.h"
#include "app/linux/stream.h"
#include "app/linux/vhost_user.h"
#include "app/linux/virtqueue.h"
#include "vp/bus/host_memory.h"
#include "vp/function/outside_host.h"

namespace hvp::guest {

// The board's PCI function as the guest's virtio device: its accesses become the outside host's,
// its memory becomes the board's to read and write, and interrupts become messages.
//
// Everything is done while the guest stands still, waiting for its next event or for an answer of
// ours, so that nothing depends on how fast either program is.
//
// A write is answered at once and made on the bus in its turn, so long as no more than kMostPosted
// are. A read is answered at its end: simulated time goes on while the guest stands in the access.
// Where one of the guest's timers is due before that end, the guest polls for the answer, every
// microsecond (virt-pci.c). The configuration space takes no time, in its turn.
class BoardDevice : public vp::InterruptListener {
 public:
  static constexpr std::size_t kMostPosted = 64;

  struct Counts {
    std::int64_t reads = 0;       // of the BAR
    std::int64_t writes = 0;      // likewise
    std::int64_t polled = 0;      // reads that a timer cut in on
    std::int64_t interrupts = 0;  // that the guest was told of
    bool overrun = false;         // more posted writes than its ring has entries
  };

  // Keeps references. `memory` is null where the board is no master.
  BoardDevice(vp::OutsideHost& host, vp::HostMemory* memory, Calendar& calendar, Stream stream);
  ~BoardDevice() override;

  int number() const { return stream_.number(); }
  // Takes and answers one message of vhost-user.
  void serve();
  // The guest waits: gives back what has ended and tells of interrupts. Whether it was told.
  bool settle();
  // What has ended is seen to, and what follows it is begun. After simulated time has gone on.
  void advance();
  // Simulated time at which settle() has something to tell of, whatever happens; none: nothing.
  std::optional<vp::Picoseconds> due() const;
  const Counts& counts() const { return counts_; }

  // InterruptListener
  void message(const vp::ConfigSpace::Message& message) override;
  void line(bool up) override;

 private:
  enum Ring : std::uint8_t { kCommands, kInterrupts, kRings };

  struct Operation {
    Virtqueue::Chain chain;
    pci::Command command;
    bool begun = false;
    bool ended = false;
  };

  std::uint64_t answer(const vhost::Header& header, std::span<const std::uint8_t> payload,
                       std::vector<Descriptor>& descriptors);
  void share_memory(std::span<const std::uint8_t> payload, std::vector<Descriptor>& descriptors);
  void unshare_memory();
  Virtqueue& ring(std::uint32_t number);
  void kicked(std::uint32_t number);
  void take_commands();
  void hold();
  void begin();
  void make_config(Operation& operation);
  void finish();
  bool reads_outstanding() const;
  void give_back();
  bool tell();
  void call(std::uint32_t number);

  vp::OutsideHost& host_;
  vp::HostMemory* memory_;
  Calendar& calendar_;
  Stream stream_;
  Stream back_channel_;
  GuestMemory guest_memory_;
  std::vector<MappedFile> mappings_;
  Virtqueue rings_[kRings];
  std::deque<Operation> operations_;    // in order; they stay where they are
  std::vector<std::uint16_t> written_;  // heads of writes that were made, not given back yet
  std::uint32_t unreclaimed_ = 0;       // entries that the guest cannot have taken back yet
  std::deque<pci::Interrupt> untold_;
  bool line_up_ = false;
  bool line_told_ = false;
  vp::Picoseconds line_again_ = 0;  // not told of before
  Counts counts_;
};

}  // namespace hvp::guest
