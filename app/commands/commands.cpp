#include "app/commands/commands.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "app/scenario/message.h"
#include "models/config/input_error.h"
#include "models/fixed/solver.h"

namespace hvp::app {

namespace {

std::string_view key_of(std::string_view override_text) {
  const std::string_view key = override_text.substr(0, override_text.find('='));
  const auto first = key.find_first_not_of(' ');
  if (first == std::string_view::npos) return {};
  return key.substr(first, key.find_last_not_of(' ') - first + 1);
}

// All changes of the scenario on the command line, as a user would write them.
std::vector<std::string> changes_of(const ScenarioArguments& arguments) {
  std::vector<std::string> changes;
  for (const std::filesystem::path& file : arguments.includes) {
    changes.push_back("include=" + file.string());
  }
  changes.insert(changes.end(), arguments.overrides.begin(), arguments.overrides.end());
  return changes;
}

// Adds the changes to the title, so that a what-if differs from the scenario from which it starts.
std::string title_of(const std::string& title, const std::vector<std::string>& all) {
  std::string changes;
  for (const std::string& o : all) {
    if (key_of(o) == "title") return title;
    if (key_of(o).starts_with("output.")) continue;  // of the same simulation
    changes += (changes.empty() ? "" : ", ") + o;
  }
  return changes.empty() ? title : fmt::format("{} [{}]", title, scenario::one_line(changes, 200));
}

// Text that a POSIX shell takes as one word.
std::string in_shell(const std::string& word) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("._/=+,:@%-").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::ranges::all_of(word, plain)) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string in_shell(const ScenarioSource& source) {
  std::string text = in_shell(source.scenario.string());
  for (const auto& file : source.includes) text += " --include " + in_shell(file.string());
  for (const auto& change : source.overrides) text += " --set " + in_shell(change);
  return text;
}

// A translation takes a minute: it is not made unasked.
void require_rtl_size(const LoadedScenario& loaded, const Scene& scene) {
  if (scene.scenario().fidelity.accelerator != vp::Timing::rtl || !scene.has_board()) return;
  if (rtl_size(scene).built) return;
  throw InputError("fidelity.accelerator",
                   fmt::format("this build has not translated the engine in SystemVerilog in the "
                               "size of this scenario: expected \"cycle-accurate\", or first the "
                               "command ./hvp rtl {}",
                               loaded.arguments));
}

}  // namespace

vp::RtlSize rtl_size(const Scene& scene) {
  const auto& matrix = scene.computation().matrix();
  return within("accelerator", [&] {
    return vp::rtl_size(scene.scenario().accelerator, scene.computation().board().settings(),
                        matrix.row_begin, matrix.column);
  });
}

void add_scenario_arguments(CLI::App& command, ScenarioArguments& arguments) {
  command.add_option("scenario", arguments.scenario, "a scenario file")
      ->required()
      ->type_name("FILE.toml");
  command
      .add_option("--include", arguments.includes,
                  "lays a file of some keys over the scenario; as often as wanted, the last on top")
      ->allow_extra_args(false)
      ->type_name("FILE.toml");
  command
      .add_option("--set", arguments.overrides,
                  "gives a key of the scenario another value; as often as wanted")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  command.add_flag("--quiet", arguments.quiet, "no progress on the terminal");
}

std::filesystem::path results_folder(const ScenarioArguments& arguments) {
  constexpr std::size_t kLongest = 120;
  std::string name = arguments.scenario.stem().string();
  std::uint64_t hash = 14695981039346656037U;  // FNV-1a
  std::string changes;
  bool lossy = false;
  for (const std::string& o : changes_of(arguments)) {
    for (const char c : o) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
    hash = (hash ^ 0x1FU) * 1099511628211U;
    changes += '+';
    for (const char c : o) {
      const bool plain = (std::isalnum(static_cast<unsigned char>(c)) != 0 &&
                          static_cast<unsigned char>(c) < 0x80U) ||
                         c == '.' || c == '=' || c == '-' || c == '_';
      if (plain) {
        changes += c;
      } else if (c == '/' || c == '[' || c == ']') {
        changes += '-';
      } else if (c != ' ' && c != '"' && c != '\'') {
        lossy = true;
      }
    }
  }
  // A hash distinguishes what-ifs whose differences are not in the name or were cut off.
  if (lossy || changes.size() > kLongest) {
    changes = changes.substr(0, kLongest - 9) + fmt::format("-{:08x}", hash & 0xFFFFFFFFU);
  }
  return std::filesystem::path("runs") / (name + changes);
}

LoadedScenario load(const ScenarioArguments& arguments) {
  LoadedScenario loaded = load_untitled(arguments);
  loaded.scenario.title = title_of(loaded.scenario.title, changes_of(arguments));
  loaded.arguments = in_shell(arguments);
  return loaded;
}

Scene build_scene(const LoadedScenario& loaded, const Progress& progress, Scene::Limits limits) {
  try {
    Scene scene(loaded.scenario, loaded.device, progress, limits);
    if (limits == Scene::Limits::refused) require_rtl_size(loaded, scene);
    return scene;
  } catch (const InputError& e) {
    throw loaded.document.complete(e);
  }
}

void check_kernel(const std::string& chosen_by) {
  try {
    fixed::chosen_kernel();
  } catch (const InputError& e) {
    throw InputError(scenario::one_line(fmt::format("{}: {}", chosen_by, e.what())));
  }
}

void print_text(std::string_view text) {
  const std::string shown = scenario::printable(text);
  std::fwrite(shown.data(), 1, shown.size(), stdout);
}

void complain(std::string_view line) {
  constexpr std::size_t kLongest = 10'000;
  fmt::print(stderr, "{}\n", scenario::one_line(line, kLongest));
}

Progress make_progress(bool quiet) {
  if (quiet || isatty(STDERR_FILENO) == 0) return {};
  return [](std::string_view what) {
    fmt::print(stderr, "\r\033[K{} …", scenario::one_line(what));
    std::fflush(stderr);
  };
}

void end_progress(bool quiet) {
  if (quiet || isatty(STDERR_FILENO) == 0) return;
  fmt::print(stderr, "\r\033[K");
}

}  // namespace hvp::app
