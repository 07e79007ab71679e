#include "app/board/model_commands.h"

#include <fmt/format.h>

#include "app/board/fault_words.h"
#include "app/scenario/message.h"
#include "models/config/input_error.h"

namespace hvp::app {

ModelCommands::ModelCommands(vp::BoardFunction& board, const Scenario& scenario)
    : board_(board), scenario_(scenario) {
  board.config().obey([this](std::string_view command) { return answer(command); });
}

std::string ModelCommands::answer(std::string_view command) {
  try {
    return obey(command);
  } catch (const InputError& e) {
    return e.what();
  }
}

std::string ModelCommands::obey(std::string_view command) {
  const auto behind = [&command](std::string_view word) {
    return command.starts_with(word) ? std::optional(command.substr(word.size())) : std::nullopt;
  };
  if (command == "stopped?") {
    if (stops_.empty()) return {};
    const Stop stop = stops_.front();
    stops_.pop_front();
    return fmt::format("{} {} {} {} {}", stop.time, stop.job, stop.offset, stop.value, stop.what);
  }
  if (const auto words = behind("fault ")) {
    inject_fault(board_, scenario_, *words);
    return {};
  }
  if (const auto words = behind("stop at ")) {
    if (!points_) points_.emplace(board_);
    points_->add(*words, [this](const Stop& stop) { stops_.push_back(stop); });
    return {};
  }
  if (const auto words = behind("stop no more at ")) {
    if (points_ && points_->remove(*words)) return {};
    throw InputError("there is no such point to take away");
  }
  throw InputError(
      fmt::format("expected \"fault …\", \"stop at …\", \"stop no more at …\" or "
                  "\"stopped?\", found {}",
                  scenario::in_quotes(command)));
}

}  // namespace hvp::app
