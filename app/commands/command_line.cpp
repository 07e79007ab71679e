#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/scenario/message.h"

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

// Commands that ./hvp of the checkout runs in place of this program.
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

// The message for an option in front of the command to which it belongs.
std::string misplaced(const std::string& name, const CLI::App& command) {
  return fmt::format("{} belongs behind the command: hvp {} … {}", name, command.get_name(), name);
}

// Describes what is wrong with the command line in one line: for a command or an option that does
// not exist with the nearest one that does, for a missing argument with the command's usage.
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

// Refuses empty file names, folders and values.
void refuse_empty_values(CLI::App& app) {
  const CLI::Validator given(
      [](const std::string& text) {
        return text.empty() ? std::string("expected a value, found \"\"") : std::string();
      },
      "");
  for (CLI::App* command : app.get_subcommands({})) {
    for (CLI::Option* option : command->get_options()) {
      if (option->get_items_expected_max() > 0) option->check(given);
    }
  }
}

}  // namespace

int parse_and_run(int argc, char** argv) {
  CLI::App app{
      "A virtual platform of a haptic system: does it meet its deadline, is it accurate\n"
      "enough, is it stable?\n\n"
      "  hvp run scenarios/thesis.toml\n"
      "  hvp run scenarios/thesis.toml --set solver.iterations=30 --set \"budget.period=1 ms\"",
      "hvp"};
  app.require_subcommand(1);
  app.set_help_flag("-h,--help", "what a command does and takes");
  app.set_version_flag("--version", "hvp " HVP_VERSION, "the program's version");
  app.footer(
      "Of many runs, by ./hvp of the checkout, which hands these to Python:\n"
      "  study    runs over axes, with screening and the price of accuracy\n"
      "  sweep    one scenario over values of a key\n"
      "  compare  two runs' settings, times, forces and flags\n"
      "  report   a page of a run or a study, for a browser\n"
      "  questions  the pages of docs/questions/, written anew from runs\n\n"
      "Exit status: 0 it ran and every budget held; 1 it ran and a budget did not hold;\n"
      "2 the input is wrong; 3 anything else. Ctrl-C ends a run after the frame at hand, with\n"
      "the results of those before, and the program as the signal would have.");
  int status = kHeld;
  for (const AddCommand add : commands()) add(app, status);

  refuse_empty_values(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    app.exit(e);  // --help, --version
    return kHeld;
  } catch (const CLI::ParseError& e) {
    complain("hvp: " + describe_usage_error(app, e));
    return kWrongInput;
  }
  return status;
}

}  // namespace hvp::app
