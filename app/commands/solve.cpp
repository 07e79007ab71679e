#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/devices/devices.h"
#include "app/results/part_files.h"
#include "app/results/results_folder.h"
#include "app/scenario/document.h"
#include "app/scenario/message.h"
#include "app/scenario/reader.h"
#include "app/solve/solve_json.h"
#include "app/solve/system_solve.h"
#include "models/accel/critical_path.h"
#include "models/config/input_error.h"
#include "models/files/regular_file.h"
#include "models/host/deviation.h"
#include "models/sparse/matrix_market.h"

namespace hvp::app {

namespace {

struct SolveArguments {
  std::filesystem::path matrix;
  std::filesystem::path rhs;
  std::filesystem::path solution = "solution.mtx";
  std::vector<std::string> overrides;  // --set key=value
  std::optional<double> tolerance;     // of error_rel; given: exit 1 beyond it
  std::string kernel;                  // in place of the environment's HVP_KERNEL
};

namespace fs = std::filesystem;

// The largest file: at forty bytes an entry it suffices for a few hundred thousand nodes.
constexpr std::uintmax_t kLargestFile = std::uintmax_t{1} << 30U;

std::string option(const char* name, const fs::path& file) {
  return fmt::format("{} {}: ", name, scenario::one_line(file.string()));
}

std::istringstream open(const char* name, const fs::path& file) {
  try {
    return std::istringstream(files::read_regular_file(file, kLargestFile, "a Matrix Market file"));
  } catch (const InputError& e) {
    throw InputError(option(name, file) + e.what());
  }
}

// Reads a file with a reader whose errors name the file and the line.
template <class Read>
auto read(const char* name, const fs::path& file, const Read& read_from) {
  std::istringstream stream = open(name, file);
  try {
    return read_from(stream, file.string());
  } catch (const InputError& e) {
    throw InputError(scenario::one_line(e.what(), 2000));
  }
}

LinearSystem read_system(const SolveArguments& a) {
  sparse::SquareMatrix matrix = read("--matrix", a.matrix, sparse::read_matrix_market);
  LinearSystem system{std::move(matrix.matrix),
                      read("--rhs", a.rhs, sparse::read_matrix_market_vector), matrix.rows};
  if (system.b.size() != static_cast<std::size_t>(system.rows)) {
    throw InputError(fmt::format("{}has {} entries: expected {}, as many as the matrix has rows",
                                 option("--rhs", a.rhs), system.b.size(), system.rows));
  }
  system.b.resize(static_cast<std::size_t>(system.matrix.rows()), 0.0);
  return system;
}

// Checks the output file before the work, so that no result is lost.
void check_solution_file(const SolveArguments& a) {
  const fs::path& file = a.solution;
  std::error_code error;
  for (const auto& [name, input] : {std::pair{"--matrix", &a.matrix}, {"--rhs", &a.rhs}}) {
    if (!fs::equivalent(file, *input, error)) continue;
    throw InputError(fmt::format("{}is the {} itself", option("--solution", file), name));
  }
  if (file.filename().empty() || fs::is_directory(file, error)) {
    throw InputError(option("--solution", file) + "is a folder: expected a file");
  }
  if (fs::exists(file, error) && !fs::is_regular_file(file, error)) {
    throw InputError(option("--solution", file) + "is not a regular file");
  }
  results::create_folder(file.has_parent_path() ? file.parent_path() : fs::path("."), "--solution");
}

bool names(const scenario::Document& document, std::string_view table, std::string_view key) {
  const scenario::Node* node = document.root().find(table);
  return node != nullptr && node->is_table() && node->find(key) != nullptr;
}

SolveTask task_of(const SolveArguments& a, const scenario::Document& document) {
  SolveTask task;
  scenario::read(document, task.settings);
  task.device = devices::find(document, task.settings.accelerator);
  if (!names(document, "accelerator", "preconditioner_memory")) {
    task.settings.choose_preconditioner_memory(task.device);
  }
  task.range_given = names(document, "solver", "displacement_range");
  task.tolerance = a.tolerance.value_or(host::Reference().tolerance);
  if (!(task.tolerance > 0) || !std::isfinite(task.tolerance)) {
    throw InputError(
        fmt::format("--tolerance {}: out of range: expected a number above zero", task.tolerance));
  }
  return task;
}

// Refuses a clock that the FPGA does not reach. A system that does not fit is solved all the same;
// the clock is then that of the largest system that fits.
void require_clock(const SolveTask& task, const LinearSystem& system,
                   const scenario::Document& document) {
  const accel::Architecture& architecture = task.settings.accelerator;
  const accel::WordLengths words = accel::word_lengths(task.settings.solver);
  const accel::Pattern pattern = accel::pattern_of(system.matrix.row_begin);
  const int nodes =
      std::min(pattern.nodes(), accel::largest_mesh(task.device, architecture, words, pattern));
  try {
    accel::require_clock({task.device, architecture, words, nodes});
  } catch (const InputError& e) {
    throw document.complete(
        InputError(e.key().empty() ? "accelerator" : "accelerator." + e.key(), e.what()));
  }
}

void choose_kernel(const std::string& kernel) {
  if (!kernel.empty()) setenv("HVP_KERNEL", kernel.c_str(), 1);
  check_kernel(kernel.empty() ? "HVP_KERNEL" : "--kernel " + kernel);
}

int solve_command(const SolveArguments& arguments) {
  const auto document = scenario::Document::of_overrides(arguments.overrides);
  const SolveTask task = task_of(arguments, document);
  choose_kernel(arguments.kernel);
  const LinearSystem system = read_system(arguments);
  check_solution_file(arguments);
  require_clock(task, system, document);
  SystemSolution solution;
  try {
    solution = solve_system(system, task);
    solution.remedy = try_remedies(system, task, solution);
  } catch (const InputError& e) {
    if (e.key().empty()) throw InputError(option("--matrix", arguments.matrix) + e.what());
    const bool complete = e.key().starts_with("accelerator");
    throw document.complete(InputError(complete ? e.key() : "solver." + e.key(), e.what()));
  }
  std::ostringstream text;
  sparse::write_matrix_market(text, solution.x);
  results::write_through_part_file(arguments.solution, text.str());
  print("{}", solve_json(system, task, solution));
  return arguments.tolerance && !(solution.error <= *arguments.tolerance) ? kNotHeld : kHeld;
}

}  // namespace

void add_solve(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<SolveArguments>();
  CLI::App* command =
      app.add_subcommand("solve",
                         "the accelerator's numbers on any symmetric positive definite "
                         "system: prints one JSON object");
  command->add_option("--matrix", arguments->matrix, "the matrix, in Matrix Market form")
      ->required()
      ->type_name("A.mtx");
  command->add_option("--rhs", arguments->rhs, "the right-hand side, likewise")
      ->required()
      ->type_name("b.mtx");
  command
      ->add_option("--solution,--out", arguments->solution,
                   "write the solution into this file, solution.mtx by default")
      ->type_name("x.mtx");
  command
      ->add_option("--set", arguments->overrides,
                   "gives a key of [solver], [refinement], [accelerator] or [spectrum] another "
                   "value; as often as wanted")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  command
      ->add_option("--tolerance", arguments->tolerance,
                   "exit with 1 where the error exceeds this part of the solution")
      ->type_name("T");
  command
      ->add_option("--kernel", arguments->kernel,
                   "which implementation computes: reference, portable, avx2 or avx512; all give "
                   "the same words, and the fastest is the default")
      ->type_name("NAME");
  command->callback([arguments, &status] { status = solve_command(*arguments); });
}

}  // namespace hvp::app
