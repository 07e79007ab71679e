#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "vp/function/outside_host.h"

namespace hvp::app {

// A stop: a point that somebody asked for has come.
struct Stop {
  std::string point;         // as it was asked for
  std::string what;          // one line: the word, the time and the job
  vp::Picoseconds time = 0;  // now
  std::int64_t job = -1;     // the newest that the host has begun, by this access too; -1: none
  std::uint32_t value = 0;   // the register's word, or the number in `point`
  std::uint64_t offset = 0;  // of the access in the BAR
};

// Points of the simulation at which somebody wants to look, in words:
//   "write to CONTROL"  the host makes such an access, which has not had an effect yet
//   "read of STATUS"    the answer has arrived; also names of the map's memories
//   (docs/registers.md) "interrupt 3"       the host is told of its third, a message or a line that
//   goes up "message 3"         likewise, of messages "job 7"             the first access of job 7
//   is about to be made; the first job is 0
// The numbers count from the board's beginning. It makes no access, takes no time and schedules
// nothing; without points none is constructed.
class StopPoints : private vp::OutsideHost::Observer {
 public:
  // `stopped` is called at the point's time, mostly from within the simulation: it must not let
  // simulated time pass.
  using Stopped = std::function<void(const Stop& stop)>;

  // Throws InputError as add() does, for what the words alone say.
  static void require_words(std::string_view words) { parse(words); }

  // From now on. Keeps a reference, also in `board`.
  explicit StopPoints(vp::BoardFunction& board) : board_(board) { board.host().observe(*this); }

  // Adds a point: an access is one as often as it comes. Throws InputError, in one line, for other
  // words and for what has been already.
  void add(std::string_view words, Stopped stopped);
  // Removes all points of these words. Returns false if there is none. Allowed while one is told.
  bool remove(std::string_view words);
  // The words of a point that has never come; empty: each has.
  std::string never_came() const;

 private:
  enum class Kind : std::uint8_t { write, read, interrupt, message, job };
  struct Point {
    std::string words;
    Kind kind = Kind::write;
    std::uint64_t begin = 0;  // of an access: bytes in the BAR
    std::uint64_t bytes = 0;
    std::int64_t number = 0;  // of the others
    Stopped stopped;
    std::int64_t came = 0;
    bool removed = false;
  };

  static Point parse(std::string_view words);
  void require_to_come(const Point& point) const;
  std::int64_t told(Kind kind) const;

  // OutsideHost::Observer
  void asked(const vp::OutsideHost::Access& access) override;
  void ended(const vp::OutsideHost::Access& access) override;
  void message(const vp::ConfigSpace::Message& message) override;
  void line(bool up) override;
  void job_began(std::int64_t number) override;

  void job(std::int64_t number);
  void accessed(Kind kind, const vp::OutsideHost::Access& access);
  void counted(Kind kind);
  void tell(Point& point, std::uint32_t value, std::uint64_t offset, const std::string& more);

  vp::BoardFunction& board_;
  std::deque<Point> points_;  // one may come while another is told
  std::int64_t begun_ = -1;   // the last job of which was told
};

}  // namespace hvp::app
