#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "app/board/fault_words.h"
#include "app/board/model_commands.h"
#include "app/board/outside_board.h"
#include "app/commands/commands.h"
#include "app/record/comparison.h"
#include "app/record/player.h"
#include "app/record/record.h"
#include "app/record/replay_figures.h"
#include "app/results/figures.h"
#include "app/scenario/message.h"
#include "vp/fpga/register_bank.h"
#include "vp/function/outside_host.h"

namespace hvp::app {

namespace {

struct ReplayArguments : ScenarioSource {  // without a scenario: the recorded one
  std::filesystem::path record;
  std::filesystem::path against;  // another record; empty: a replay
  bool times = false;             // a difference of times counts
  bool json = false;
};

// The scenario of the command line, or the recorded one, changed by --set.
LoadedScenario scenario_of(const ReplayArguments& arguments, const record::Record& recorded) {
  if (!arguments.scenario.empty()) return load_untitled(arguments);
  // Errors name the line of what `hvp resolve` would have printed, and no file that could be there.
  const std::string name = "scenario of " + arguments.record.filename().string();
  return read_document(scenario::Document::parse(recorded.scenario(), name, arguments.overrides));
}

void warn_of_a_cut(const std::filesystem::path& file, const record::Record& recorded) {
  if (recorded.cut().empty()) return;
  spdlog::warn("{}: {}: read until there", scenario::one_line(file.string()), recorded.cut());
}

int report(const ReplayArguments& arguments, const record::Record& recorded,
           const record::Record& other, const vp::RegisterBank& bank) {
  const record::Comparison comparison = record::compare(recorded, other);
  const record::ReplayFigures figures = record::figures_of(
      recorded, comparison, [&bank](std::uint64_t offset) { return bank.name_at(offset); });
  if (arguments.json) {
    print("{}\n", results::figures_json(figures).dump(2));
  } else {
    print("{}", record::text_of(figures, arguments.against.empty() ? "replayed" : "against"));
  }
  const bool equal = comparison.alike() && (!arguments.times || !comparison.first_of_time);
  return equal ? kHeld : kNotHeld;
}

int replay_command(const ReplayArguments& arguments) {
  const record::Record recorded = record::read_record(arguments.record);
  warn_of_a_cut(arguments.record, recorded);
  // Nothing compared would be nothing that differs.
  if (std::ranges::find(recorded.entries(), record::Kind::ended, &record::Entry::kind) ==
      recorded.entries().end()) {
    throw InputError(fmt::format("{}: no access was recorded: expected at least one",
                                 scenario::one_line(arguments.record.string())));
  }
  if (!arguments.against.empty()) {
    const record::Record other = record::read_record(arguments.against);
    warn_of_a_cut(arguments.against, other);
    return report(arguments, recorded, other, vp::RegisterBank());
  }
  check_kernel("HVP_KERNEL");
  const LoadedScenario loaded = scenario_of(arguments, recorded);
  vp::BoardFunction board(outside_board(loaded));
  const Scenario& s = loaded.scenario;
  const bool late = recorded.layer() == record::Layer::kernel && s.guest.has_value();
  if (late) board.host().take_interrupts_late(s.host, s.seed);
  // As the commands of those layers have it.
  std::optional<ModelCommands> commands;
  if (recorded.layer() != record::Layer::program) commands.emplace(board, s);
  record::Player player(board, recorded, scenario::one_line(arguments.record.string()),
                        [&](std::string_view words) { inject_fault(board, s, words); });
  const record::Record replayed = player.play();
  warn_of_faults_that_never_struck(board);
  return report(arguments, recorded, replayed, board.accelerator().bank());
}

}  // namespace

void add_replay(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<ReplayArguments>();
  CLI::App* command = app.add_subcommand(
      "replay", "make recorded accesses again, on any scenario's board: the first that differs");
  command->add_option("record", arguments->record, "what --record has written")
      ->required()
      ->type_name("RECORD");
  CLI::Option* scenario = command
                              ->add_option("scenario", arguments->scenario,
                                           "a scenario file, in place of the recorded scenario")
                              ->type_name("FILE.toml");
  command
      ->add_option(
          "--include", arguments->includes,
          "lays a file of some keys over the scenario; as often as wanted, the last on top")
      ->allow_extra_args(false)
      ->needs(scenario)
      ->type_name("FILE.toml");
  CLI::Option* set = command
                         ->add_option("--set", arguments->overrides,
                                      "gives a key of the scenario another value; as often as "
                                      "wanted")
                         ->allow_extra_args(false)
                         ->type_name("KEY=VALUE");
  command
      ->add_option("--against", arguments->against,
                   "compare with this record, such as of another driver, and replay nothing")
      ->excludes(scenario)
      ->excludes(set)
      ->type_name("RECORD");
  command->add_flag("--times", arguments->times, "a difference of times counts, too");
  command->add_flag("--json", arguments->json, "as one JSON object");
  command->callback([arguments, &status] { status = replay_command(*arguments); });
}

}  // namespace hvp::app
