#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "app/linux/stream.h"
#include "vp/frame/frame_tag.h"

namespace hvp::guest {

// The current simulated time for the guest. The guest's clock counts nanoseconds and simulated time
// picoseconds, so an event between two nanoseconds happens at the next one.
inline std::uint64_t now_ns() { return static_cast<std::uint64_t>((vp::now_ps() + 999) / 1000); }
inline bool whole_ns() { return vp::now_ps() % 1000 == 0; }

// Clamps to 106 days, longer than any run.
inline vp::Picoseconds to_ps(std::uint64_t ns) {
  constexpr std::uint64_t kMost = std::numeric_limits<vp::Picoseconds>::max() / 1000;
  return static_cast<vp::Picoseconds>(std::min(ns, kMost)) * 1000;
}

// The guest's clock: the calendar of linux/um_timetravel.h, with a User-Mode Linux with
// time-travel=ext on the other side. The guest's time is simulated time in whole nanoseconds. The
// guest learns it when it asks and when it is allowed to run; its processor takes no time. It tells
// when its next timer is due, and when it waits. Between these messages simulated time advances
// only as far as an access to the board needs.
class Calendar {
 public:
  // A request for this time or later means that the guest has no timer.
  static constexpr std::uint64_t kNever = std::uint64_t{1} << 62U;  // ns, 146 years

  Calendar() = default;
  explicit Calendar(Stream stream) : stream_(std::move(stream)) {}
  bool connected() const { return static_cast<bool>(stream_); }
  int number() const { return stream_.number(); }

  // Receives and answers one message at the simulated time `now` in ns. Throws GuestError if the
  // message does not follow the protocol, or if the guest's time differs.
  void serve(std::uint64_t now);
  // Tells the guest the time `now` and returns after its acknowledgement. A waiting guest then
  // runs.
  void run(std::uint64_t now);

  bool waiting() const { return waiting_; }
  // The time since which the guest has been waiting, ns.
  std::uint64_t waits_since() const { return waits_since_; }
  // The time at which the guest wants to run next, ns; none: it has not told.
  std::optional<std::uint64_t> requested() const { return requested_; }
  // The time in ns up to which the simulation may advance while the guest runs, in an access for
  // which it waits. The guest's next timer is the limit; before the guest has told it, time may not
  // advance.
  std::uint64_t latest(std::uint64_t now) const { return requested_.value_or(now); }
  // The time that the guest was last told, ns.
  std::uint64_t told() const { return told_; }

 private:
  Stream stream_;
  bool waiting_ = false;
  bool heard_ = false;  // the guest has answered run()
  std::optional<std::uint64_t> requested_;
  std::uint64_t waits_since_ = 0;
  std::uint64_t told_ = 0;
  std::uint32_t sequence_ = 0;
};

}  // namespace hvp::guest
