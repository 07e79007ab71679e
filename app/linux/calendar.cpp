#include "app/linux/calendar.h"

#include <array>

#include <fmt/format.h>

#include "app/linux/bytes.h"
#include "app/linux/guest_error.h"

namespace hvp::guest {

namespace {

// enum um_timetravel_ops
enum class Operation : std::uint32_t {
  acknowledge = 0,
  start = 1,
  request = 2,
  wait = 3,
  get = 4,
  update = 5,
  run = 6,
  time_of_day = 8,
};

using Message = std::array<std::uint8_t, 16>;

Message compose(Operation operation, std::uint32_t sequence, std::uint64_t time) {
  Message message{};
  put_number(message, 0, static_cast<std::uint32_t>(operation));
  put_number(message, 4, sequence);
  put_number(message, 8, time);
  return message;
}

// The date at simulated time 0, the same for every run: 1 January 2025, 0:00 UTC.
constexpr std::uint64_t kDate = std::uint64_t{1'735'689'600} * 1'000'000'000;

}  // namespace

void Calendar::serve(std::uint64_t now) {
  Message message{};
  stream_.receive(message);
  const auto operation = number_at<std::uint32_t>(message, 0);
  const auto sequence = number_at<std::uint32_t>(message, 4);
  const auto time = number_at<std::uint64_t>(message, 8);
  std::uint64_t answer = 0;
  switch (static_cast<Operation>(operation)) {
    case Operation::acknowledge:
      if (sequence == sequence_) heard_ = true;
      return;
    case Operation::start:
      break;
    case Operation::request:
      if (time < now) {
        throw GuestError(
            fmt::format("the guest wants to run at {} ns, and it is {} ns", time, now));
      }
      requested_ = time;
      break;
    case Operation::wait:
      waiting_ = true;
      waits_since_ = now;
      break;
    case Operation::get:
      answer = now;
      told_ = now;
      break;
    case Operation::update:
      if (time != now) {
        throw GuestError(fmt::format("the guest's time is {} ns, and it is {} ns", time, now));
      }
      break;
    case Operation::time_of_day:
      answer = kDate + now;
      break;
    default:
      throw GuestError(
          fmt::format("the guest's calendar asks for {}, expected 0 to 5 or 8", operation));
  }
  stream_.send(compose(Operation::acknowledge, sequence, answer));
}

void Calendar::run(std::uint64_t now) {
  if (waiting_) requested_.reset();
  waiting_ = false;
  heard_ = false;
  told_ = now;
  stream_.send(compose(Operation::run, ++sequence_, now));
  while (!heard_) serve(now);
}

}  // namespace hvp::guest
