#include "vp/pcie/posted_path.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace hvp::vp {

namespace {

constexpr std::size_t kPlaces = 256;
constexpr std::size_t kPlacesOfWrites = 64;  // the others are left to messages, which cannot wait

}  // namespace

PostedPath::PostedPath(const sc_core::sc_module_name& name, PcieTiming& timing,
                       PcieTiming::Sender sender, std::int64_t unit, Picoseconds pace,
                       Ledger& ledger, Left left, Deliver deliver)
    : sc_module(name),
      timing_(timing),
      sender_(sender),
      unit_(unit),
      pace_(pace),
      ledger_(ledger),
      left_(std::move(left)),
      deliver_(std::move(deliver)),
      writes_(kPlaces) {
  SC_HAS_PROCESS(PostedPath);
  SC_THREAD(send);
  SC_THREAD(deliver);
  set_stack_size(kTargetsStackBytes);
}

PostedWrite& PostedPath::push(std::uint64_t address, const std::uint8_t* data, std::size_t bytes,
                              const Tag& tag) {
  PostedWrite& write = writes_.push(address, data, bytes);
  write.tag = tag;
  write.began = now_ps();
  write.due = now_ps();
  ledger_.hold(tag);
  ++posted_;
  pushed_.notify();
  return write;
}

PostedWrite& PostedPath::post(const tlm::tlm_generic_payload& transaction, const Tag& tag) {
  while (writes_.count() >= kPlacesOfWrites) wait(one_delivered_);
  return push(transaction.get_address(), transaction.get_data_ptr(), transaction.get_data_length(),
              tag);
}

PostedWrite& PostedPath::post_message(std::uint64_t code, const Tag& tag) {
  if (writes_.full()) throw std::logic_error("messages pile up on the PCIe link");
  PostedWrite& message = push(code, nullptr, 0, tag);
  message.phase = Phase::message;
  return message;
}

void PostedPath::send() {
  while (true) {
    while (on_their_way_ == writes_.count()) wait(pushed_);
    PostedWrite& write = writes_.at(on_their_way_);
    const Picoseconds first = write.due;
    const auto bytes = static_cast<std::int64_t>(write.data.size());
    const std::int64_t unit = unit_ > 0 ? unit_ : bytes;
    std::int64_t gone = 0;
    do {
      wait_until(first + (unit > 0 ? gone / unit : 0) * pace_);
      const std::int64_t now = std::min(unit, bytes - gone);
      write.due = timing_.send(sender_, now, {write.phase, write.tag.frame});
      gone += now;
    } while (gone < bytes);
    left_(write);
    ++on_their_way_;
    ++sent_;
    one_left_.notify();
  }
}

void PostedPath::deliver() {
  while (true) {
    while (on_their_way_ == 0) wait(one_left_);
    PostedWrite& write = writes_.front();
    wait_until(write.due);
    const Tag held = write.tag;
    deliver_(write);
    ledger_.unhold(held);
    writes_.pop();
    --on_their_way_;
    ++delivered_;
    one_delivered_.notify();
  }
}

void PostedPath::wait_until_left(std::int64_t count) {
  while (sent_ < count) wait(one_left_);
}

void PostedPath::wait_until_delivered(std::int64_t count) {
  while (delivered_ < count) wait(one_delivered_);
}

}  // namespace hvp::vp
