#pragma once

#include <string>

// NOLINTNEXTLINE(readability-identifier-naming): the library's own name
namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace hvp::app {

// What is wrong with the command line, in one line: a command or an option that does not exist
// comes with the nearest one that does, and what is missing with the command's usage.
std::string describe_usage_error(const CLI::App& app, const CLI::ParseError& error);

}  // namespace hvp::app
