#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include <fmt/format.h>

namespace hvp::app {

// Checks an option's number. CLI11's own Range takes what is no number at all, nan.
inline CLI::Validator number_between(double low, double high) {
  return CLI::Validator(
      [low, high](std::string& text) -> std::string {
        double value = 0;
        if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high) return {};
        return fmt::format("expected a number from {:g} to {:g}, found {}", low, high, text);
      },
      "");
}

}  // namespace hvp::app
