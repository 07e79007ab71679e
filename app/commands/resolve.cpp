#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/results/results_folder.h"
#include "app/scenario/files.h"
#include "app/scenario/message.h"
#include "models/config/input_error.h"

namespace hvp::app {

namespace {

struct ResolveArguments : ScenarioArguments {
  bool each = false;  // for every line of the standard input, with its overrides
};

using nlohmann::json;
using nlohmann::ordered_json;

constexpr std::size_t kLongestLine = 1U << 20U;

// Writes the text unchanged: its bytes equal those of the file that a run writes.
void write_out(std::string_view text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  // The reader waits for this answer before it sends the next line.
  if (!written || std::fflush(stdout) != 0) {
    throw std::runtime_error("cannot write to standard output");
  }
}

InputError wrong_line(int number, const std::string& found) {
  return InputError(fmt::format(
      "resolve --each: line {} of the standard input: expected a JSON array of texts such as "
      "[\"frames=300\", \"bus.kind=pci-64/66\"], found {}",
      number, found));
}

// Returns a line without its line break, or nothing at the end of the input.
std::optional<std::string> next_line(int number) {
  std::string line;
  int c = std::getc(stdin);
  if (c == EOF) return std::nullopt;
  for (; c != EOF && c != '\n'; c = std::getc(stdin)) {
    if (line.size() == kLongestLine) throw wrong_line(number, "a line of more than 1 MiB");
    line += static_cast<char>(c);
  }
  return line;
}

std::vector<std::string> overrides_of(const std::string& line, int number) {
  const json list = json::parse(line, nullptr, false);
  bool is_list = list.is_array();
  if (is_list) {
    for (const json& item : list) is_list = is_list && item.is_string();
  }
  if (!is_list) throw wrong_line(number, scenario::in_quotes(line));
  return list.get<std::vector<std::string>>();
}

ordered_json answer(const ScenarioArguments& arguments) {
  try {
    const LoadedScenario loaded = load_untitled(arguments);
    ordered_json files = ordered_json::array();
    for (const scenario::NamedFile& file : scenario::files_of(loaded.scenario)) {
      files.push_back({{"key", file.key}, {"path", file.path.string()}});
    }
    if (!loaded.device_file.empty()) {
      files.push_back({{"key", "accelerator.device"}, {"path", loaded.device_file.string()}});
    }
    return {{"scenario", results::resolved_text(loaded.scenario, loaded.device_file)},
            {"files", files}};
  } catch (const InputError& e) {
    return {{"error", e.what()}};
  }
}

void answer_each(const ScenarioArguments& arguments) {
  // Errors that no line can correct are reported before the first line is read.
  scenario::Document::load(arguments.scenario, arguments.overrides, arguments.includes);
  for (int number = 1; const std::optional<std::string> line = next_line(number); ++number) {
    ScenarioArguments changed = arguments;
    for (std::string& text : overrides_of(*line, number)) {
      changed.overrides.push_back(std::move(text));
    }
    // The output is ASCII, so that it needs no agreement on an encoding; a path need not be UTF-8.
    write_out(answer(changed).dump(-1, ' ', true, json::error_handler_t::replace) + '\n');
  }
}

int resolve_command(const ResolveArguments& arguments) {
  if (arguments.each) {
    answer_each(arguments);
    return kHeld;
  }
  const LoadedScenario loaded = load(arguments);
  write_out(results::resolved_text(loaded.scenario, loaded.device_file));
  return kHeld;
}

}  // namespace

void add_resolve(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<ResolveArguments>();
  CLI::App* command = app.add_subcommand(
      "resolve", "print every setting of a scenario as it would be run, checked, and run nothing");
  add_scenario_arguments(*command, *arguments);
  command->add_flag("--each", arguments->each,
                    "for each line of the standard input, a JSON array of KEY=VALUE that are laid "
                    "over it, print one of JSON (docs/json.md)");
  command->callback([arguments, &status] { status = resolve_command(*arguments); });
}

}  // namespace hvp::app
