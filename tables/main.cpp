// Computes the pages of figures in docs/ and prints them.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>

#include "tables/pages.h"

namespace {

void print(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stdout); }

int run(int argc, char** argv) {
  CLI::App app{"Computes the tables of figures in docs/ and prints them."};
  app.require_subcommand(1);
  CLI::App* thesis = app.add_subcommand("thesis", "Tables 4.1 and 4.2 of the thesis: Markdown");
  bool csv = false;
  thesis->add_flag("--csv", csv, "the errors alone, one line each, to plot");
  const CLI::App* hard = app.add_subcommand("hard-cases", "the hard cases and their remedies");
  CLI::App* accelerator =
      app.add_subcommand("accelerator", "Tables 5.1, 6.1, 6.2 and 6.4 of the thesis");
  bool measure = false;
  accelerator->add_flag("--measure", measure, "and Table 6.3, with this machine's row");
  const CLI::App* devices = app.add_subcommand("devices", "the FPGAs that a scenario can name");
  const CLI::App* buses = app.add_subcommand("buses", "what links carry and transfers cost");
  const CLI::App* elements =
      app.add_subcommand("elements", "linear and quadratic elements: locking, cost on the board");
  const CLI::App* partitions =
      app.add_subcommand("partitions", "partitions of K: zeros isolated, balance, exchanged words");
  CLI::App* coverage =
      app.add_subcommand("fit-coverage", "how often the intervals of hvp fit cover the truth");
  int seeds = 200;
  coverage->add_option("--seeds", seeds, "logs of each model, 200 by default")
      ->check(CLI::Range(1, 100'000));
  const CLI::App* pc =
      app.add_subcommand("pc", "Table 6.3 with this machine's row, measured in about a second");
  const CLI::App* synthesis =
      app.add_subcommand("synthesis", "what a synthesis makes of the engine: measured.csv");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    return app.exit(e);  // --help
  } catch (const CLI::ParseError& e) {
    std::string names;
    for (const CLI::App* page : app.get_subcommands({})) names += " " + page->get_name();
    std::fprintf(stderr, "hvp-tables: %s: expected one of%s\n",
                 argc > 1 ? argv[argc - 1] : "no name", names.c_str());
    return 2;
  }
  if (thesis->parsed()) print(csv ? hvp::tables::thesis_csv() : hvp::tables::thesis_page());
  if (accelerator->parsed()) print(hvp::tables::accelerator_page());
  if (measure) print("\n## Table 6.3: beside a PC\n\n" + hvp::tables::pc_table());
  if (devices->parsed()) print(hvp::tables::devices_page());
  if (buses->parsed()) print(hvp::tables::buses_page());
  if (coverage->parsed()) print(hvp::tables::fit_coverage_page(seeds));
  if (elements->parsed()) print(hvp::tables::elements_page());
  if (partitions->parsed()) print(hvp::tables::partitions_page());
  if (pc->parsed()) print(hvp::tables::pc_table());
  if (synthesis->parsed()) {
    print(hvp::tables::synthesis_page(HVP_SOURCE_DIR "/tables/synthesis"));
  }
  if (hard->parsed()) print(hvp::tables::hard_cases_page());
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    throw std::runtime_error("cannot write to standard output");
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "hvp-tables: %s\n", error.what());
    return 3;
  }
}
