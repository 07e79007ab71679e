#include "app/commands/usage_error.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "app/scenario/message.h"
#include "app/scenario/nearest.h"

namespace hvp::app {
namespace {

std::string unknown(std::string_view what, const std::string& name,
                    const std::vector<std::string>& valid) {
  const std::string_view near =
      scenario::nearest(name, std::vector<std::string_view>(valid.begin(), valid.end()));
  const std::string shown = scenario::one_line(name);
  if (!near.empty()) return fmt::format("{} {}; did you mean {}?", what, shown, near);
  return fmt::format("{} {}; there is {}", what, shown, fmt::join(valid, ", "));
}

// What the entry of the checkout runs in place of this program.
constexpr std::array<std::string_view, 4> kOfTheCheckout = {"study", "sweep", "compare", "report"};

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

bool has_option(const CLI::App& app, const std::string& name) {
  const std::vector<std::string> names = option_names(app);
  return std::find(names.begin(), names.end(), name) != names.end();
}

// An option in front of the command that it belongs to.
std::string misplaced(const std::string& name, const CLI::App& command) {
  return fmt::format("{} belongs behind the command: hvp {} … {}", name, command.get_name(), name);
}

}  // namespace

std::string describe_usage_error(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> given = app.get_subcommands();
  const std::vector<std::string> rest = app.remaining(true);
  if (given.empty()) {
    if (rest.empty()) {
      return fmt::format("expected a command: {} (hvp --help describes them)",
                         fmt::join(command_names(app), ", "));
    }
    if (std::ranges::find(kOfTheCheckout, rest[0]) != kOfTheCheckout.end()) {
      return fmt::format("{0} is run by ./hvp {0} …", rest[0]);
    }
    if (!rest[0].starts_with("-")) return unknown("unknown command", rest[0], command_names(app));
    const std::string name = rest[0].substr(0, rest[0].find('='));
    for (const CLI::App* command : app.get_subcommands({})) {
      if (has_option(*command, name)) return misplaced(name, *command);
    }
    return unknown("unknown option", name, option_names(app));
  }
  const CLI::App& command = *given[0];
  if (!rest.empty()) {
    const std::string name = rest[0].substr(0, rest[0].find('='));
    const std::string what = command.get_name() + ": unknown option";
    if (has_option(command, name)) return misplaced(name, command);
    if (name.starts_with("-")) return unknown(what, name, option_names(command));
    return fmt::format("{}: one argument too many: {}", command.get_name(),
                       scenario::one_line(rest[0]));
  }
  return fmt::format("{}: {} (hvp {} --help shows what it takes)", command.get_name(),
                     scenario::one_line(error.what()), command.get_name());
}

}  // namespace hvp::app
