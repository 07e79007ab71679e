#include "app/scenario/reference.h"

#include <CLI/CLI.hpp>
#include <memory>

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/commands/results_reference.h"

namespace hvp::app {

namespace {

struct ReferenceArguments {
  bool results = false;  // docs/results-reference.md in place of docs/scenario-reference.md
  bool json = false;     // all that is declared, in place of a page
};

int reference_command(const ReferenceArguments& arguments) {
  if (arguments.json) {
    print("{}", reference_json(HVP_VERSION));
    return kHeld;
  }
  print("{}", arguments.results ? results_reference_page() : scenario::reference_page(Scenario{}));
  return kHeld;
}

}  // namespace

void add_reference(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<ReferenceArguments>();
  CLI::App* command = app.add_subcommand(
      "reference", "print every key of a scenario: unit, range, default, source");
  CLI::Option* results =
      command->add_flag("--results", arguments->results,
                        "every key of summary.json and column of frames.csv instead");
  command
      ->add_flag("--json", arguments->json,
                 "keys, effects, figures, columns and flags as one JSON object")
      ->excludes(results);
  command->callback([arguments, &status] { status = reference_command(*arguments); });
}

}  // namespace hvp::app
