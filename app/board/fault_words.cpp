#include "app/board/fault_words.h"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/scenario/document.h"
#include "app/scenario/message.h"
#include "app/scenario/reader.h"
#include "models/config/input_error.h"

namespace hvp::app {

namespace {

constexpr std::string_view kBlanks = " \t\n";

// An item of [[fault]] by itself.
struct Item {
  vp::Fault fault;

  void declare(config::Visitor& v) { fault.declare(v); }
  void check() const { fault.check_injected(); }
};

std::vector<std::string> split(std::string_view words) {
  std::vector<std::string> all;
  for (std::size_t begin = 0; begin <= words.size();) {
    const std::size_t end = std::min(words.find(',', begin), words.size());
    std::string_view word = words.substr(begin, end - begin);
    word.remove_prefix(std::min(word.find_first_not_of(kBlanks), word.size()));
    word.remove_suffix(word.size() - (word.find_last_not_of(kBlanks) + 1));
    all.emplace_back(word);
    begin = end + 1;
  }
  return all;
}

void require_to_come(const vp::JobFrames& jobs, const vp::Fault& fault) {
  const std::int64_t first = jobs.jobs() - (jobs.is_open() ? 1 : 0);
  if (fault.frame < 0 || fault.frame >= first) return;
  throw InputError("frame",
                   fmt::format("job {} is over: expected {} or later", fault.frame, first));
}

// An item has each key once, and no word without one.
void require_keys(const std::vector<std::string>& words) {
  std::vector<std::string_view> keys;
  for (const std::string_view word : words) {
    const std::size_t equals = word.find('=');
    std::string_view key = word.substr(0, equals);
    key = key.substr(0, key.find_last_not_of(kBlanks) + 1);
    if (equals == std::string_view::npos || key.empty()) {
      throw InputError(fmt::format("{}: expected KEY=VALUE, such as kind=lost-interrupt",
                                   word.empty() ? "an empty word" : scenario::one_line(word)));
    }
    if (std::ranges::find(keys, key) != keys.end()) {
      throw InputError(
          fmt::format("{}: is there twice: expected it once", scenario::one_line(key)));
    }
    keys.push_back(key);
  }
}

// The words stand behind the name of the call, not behind an option.
std::string without_option(std::string_view line) {
  constexpr std::string_view kOption = "--set ";
  if (line.starts_with(kOption)) line.remove_prefix(kOption.size());
  return std::string(line);
}

}  // namespace

void inject_fault(vp::BoardFunction& board, const Scenario& scenario, std::string_view words) {
  Item item;
  try {
    const std::vector<std::string> all = split(words);
    require_keys(all);
    const auto document = scenario::Document::of_overrides(all);
    try {
      scenario::read(document, item);
      require_possible(scenario, item.fault);
      require_to_come(board.host().frames(), item.fault);
    } catch (const InputError& e) {
      throw document.complete(e);
    }
  } catch (const InputError& e) {
    throw InputError(without_option(e.what()));
  }
  board.host().inject(item.fault);
}

}  // namespace hvp::app
