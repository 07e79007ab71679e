#pragma once

#include <string>

// The pages of figures in docs/, in Markdown.
namespace hvp::tables {

// docs/accelerator-tables.md: the thesis' Tables 5.1, 6.1, 6.2 and 6.4 beside the model's figures.
std::string accelerator_page();

// docs/bus-tables.md: the rates of links, the costs of the ways to move a frame's data, and the
// effect of a second master.
std::string buses_page();

// docs/devices.md: the built-in FPGAs, from their files, and how to add one.
std::string devices_page();

// docs/elements.md: what linear and quadratic elements make of a body that is pressed and of one
// that is bent, and what they cost the board.
std::string elements_page();

// docs/fit-coverage.md: how often the 95 % intervals of every model's parameters cover the truth,
// over `seeds` seeds of noise.
std::string fit_coverage_page(int seeds);

// docs/hard-cases.md: every hard case followed to its end.
std::string hard_cases_page();

// docs/partitions.md.
std::string partitions_page();

// Thesis Table 6.3 with a row for this machine, measured in about a second. The row differs from
// run to run.
std::string pc_table();

// docs/synthesis.md: the engine in SystemVerilog, synthesised, beside what the model says of it,
// from engines.csv and measured.csv in `folder`.
std::string synthesis_page(const std::string& folder);

// docs/thesis-tables.md.
std::string thesis_page();

// The data of the thesis' plot: "series,iterations,error_rounded,error_true" for every fifth
// iteration. The thesis' own columns have no error_true.
std::string thesis_csv();

}  // namespace hvp::tables
