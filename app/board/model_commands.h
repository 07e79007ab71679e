#pragma once

#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "app/board/stop_points.h"
#include "app/scene/scenario.h"
#include "vp/function/outside_host.h"

namespace hvp::app {

// What a host without a call into this program asks of the model, through the function's own
// capability (docs/pci-function.md):
//   "fault kind=…,…"   inject_fault(); answers nothing, or why it is refused in a line
//   "stop at POINT"    StopPoints::add(); likewise
//   "stop no more at POINT"
//   "stopped?"         the oldest stop of which nobody was told: "TIME_PS JOB OFFSET VALUE WHAT";
//                      nothing if there is none
// Without a command nothing is constructed in the board.
class ModelCommands {
 public:
  // Keeps references. To be called before the simulation begins.
  ModelCommands(vp::BoardFunction& board, const Scenario& scenario);
  ModelCommands(const ModelCommands&) = delete;
  ModelCommands& operator=(const ModelCommands&) = delete;

  // True if there was a stop of which nobody was told.
  bool stopped() const { return !stops_.empty(); }

 private:
  std::string answer(std::string_view command);
  std::string obey(std::string_view command);

  vp::BoardFunction& board_;
  Scenario scenario_;
  std::optional<StopPoints> points_;
  std::deque<Stop> stops_;
};

}  // namespace hvp::app
