#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "app/linux/stream.h"

namespace hvp::guest {

// The guest's clock: the calendar of linux/um_timetravel.h, whose other side is a User-Mode Linux
// with time-travel=ext. Its time is simulated time in whole nanoseconds, which the guest hears of
// when it asks and when it is let run; its processor takes no time. It says at what time it has
// something to do next and that it waits; in between nothing of the simulation goes on, but for
// what an access to the board waits for.
class Calendar {
 public:
  // A request for this time or later is none: the guest has no timer.
  static constexpr std::uint64_t kNever = std::uint64_t{1} << 62U;  // ns, 146 years

  Calendar() = default;
  explicit Calendar(Stream stream) : stream_(std::move(stream)) {}
  bool connected() const { return static_cast<bool>(stream_); }
  int number() const { return stream_.number(); }

  // Takes and answers one message, at this simulated time in nanoseconds. Throws GuestError for
  // what is no message of the protocol, or a guest that believes in another time.
  void serve(std::uint64_t now);
  // Tells the guest that it is `now`, and returns when it has heard. A guest that waits goes on.
  void run(std::uint64_t now);

  bool waiting() const { return waiting_; }
  // Since when it waits.
  std::uint64_t waits_since() const { return waits_since_; }
  // When the guest wants to run next; none: it has not said.
  std::optional<std::uint64_t> requested() const { return requested_; }
  // How far simulated time may go while the guest runs, in an access that it waits for: its next
  // timer must not be overslept. From being let run until it has said when that is, not at all.
  std::uint64_t latest(std::uint64_t now) const { return requested_.value_or(now); }
  // What it has heard last.
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
