#pragma once

#include <cstdint>
#include <functional>
#include <systemc>

#include "vp/bus/bus_transaction.h"
#include "vp/frame/ledger.h"
#include "vp/pcie/pcie_timing.h"

namespace hvp::vp {

// The queue of posted packets of one direction of a PCI Express link: one process sends them in
// order, another delivers those that have arrived, so that the next is on its way meanwhile.
class PostedPath : public sc_core::sc_module {
 public:
  // Called in the delivering process when a write has arrived. The target's wait states delay the
  // packets behind it.
  using Deliver = std::function<void(PostedWrite&)>;
  // Called in the sending process when a write has left.
  using Left = std::function<void(PostedWrite&)>;

  // A write goes in units of `unit` bytes (0: whole), of which one reaches the port in `pace`.
  PostedPath(const sc_core::sc_module_name& name, PcieTiming& timing, PcieTiming::Sender sender,
             std::int64_t unit, Picoseconds pace, Ledger& ledger, Left left, Deliver deliver);

  // Waits while the queue is full. The write reaches the port at `due` of the returned entry. The
  // caller sets tag, phase and began of the entry before it waits.
  PostedWrite& post(const tlm::tlm_generic_payload& transaction, const Tag& tag);
  // Sends a packet without data, without waiting. Throws std::logic_error if hundreds are under
  // way.
  PostedWrite& post_message(std::uint64_t code, const Tag& tag);

  // The number of posted packets; the two calls wait for one of them or all.
  std::int64_t posted() const { return posted_; }
  void wait_until_left(std::int64_t count);
  void wait_until_delivered(std::int64_t count);

 private:
  void send();
  void deliver();
  PostedWrite& push(std::uint64_t address, const std::uint8_t* data, std::size_t bytes,
                    const Tag& tag);

  PcieTiming& timing_;
  PcieTiming::Sender sender_;
  std::int64_t unit_;
  Picoseconds pace_;
  Ledger& ledger_;
  Left left_;
  Deliver deliver_;
  PostedWrites writes_;
  std::size_t on_their_way_ = 0;  // number of writes, from the front, that have left
  std::int64_t posted_ = 0;
  std::int64_t sent_ = 0;
  std::int64_t delivered_ = 0;
  // One event for each kind of wait, because waking a process takes a tenth of a microsecond of
  // wall time.
  sc_core::sc_event pushed_;
  sc_core::sc_event one_left_;
  sc_core::sc_event one_delivered_;
};

}  // namespace hvp::vp
