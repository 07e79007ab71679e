#pragma once

#include <cstdint>
#include <functional>
#include <systemc>

#include "vp/bus/posted_writes.h"
#include "vp/frame/ledger.h"
#include "vp/pcie/pcie_timing.h"

namespace hvp::vp {

// The posted packets of one direction of a PCI Express link, in their order: one process sends
// them, another delivers those that have arrived, so that the next is on its way meanwhile.
class PostedPath : public sc_core::sc_module {
 public:
  // Called in the delivering process, when a write has arrived: its target's wait states delay what
  // is behind it.
  using Deliver = std::function<void(PostedWrite&)>;
  // Called in the sending process, when a write has left.
  using Left = std::function<void(PostedWrite&)>;

  // A write goes in units of so many bytes (0: whole), of which one reaches the port in `pace`.
  PostedPath(const sc_core::sc_module_name& name, PcieTiming& timing, PcieTiming::Sender sender,
             std::int64_t unit, Picoseconds pace, Ledger& ledger, Left left, Deliver deliver);

  // Waits while too much is under way. The write reaches the port at `due` of what is returned,
  // which the caller sets with tag, phase and began before it waits for anything.
  PostedWrite& post(const tlm::tlm_generic_payload& transaction, const Tag& tag);
  // A packet without data; does not wait. Throws std::logic_error when hundreds are under way.
  PostedWrite& post_message(std::uint64_t code, const Tag& tag);

  // How many have been posted; what waits for one or all of them.
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
  std::size_t on_their_way_ = 0;  // of them, from the front: have left
  std::int64_t posted_ = 0;
  std::int64_t sent_ = 0;
  std::int64_t delivered_ = 0;
  // Each wakes those alone who wait for it: a wake-up is a tenth of a microsecond of wall time.
  sc_core::sc_event pushed_;
  sc_core::sc_event one_left_;
  sc_core::sc_event one_delivered_;
};

}  // namespace hvp::vp
