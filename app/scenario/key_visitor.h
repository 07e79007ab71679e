#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "models/config/declaration.h"

namespace hvp::scenario {

// The type of a key, the values that it admits, and one of them.
struct Key {
  enum class Kind { quantity, vector, integer, boolean, text, file, choice };
  Kind kind = Kind::text;
  // In SI units; a file as the scenario writes it, a choice by its name.
  std::variant<std::string, double, Eigen::Vector3d, std::int64_t, bool> value = {};
  config::Dimension dimension = config::Dimension::dimensionless;  // of a quantity or a vector
  config::Range range = {};                                        // of these
  config::IntegerRange integers = {};                              // of an integer
  std::vector<std::string> choices = {};                           // of a choice
  std::string word = {};  // that may stand in a quantity's place
};

// The value as a scenario writes it. Throws std::invalid_argument for a double that is not finite.
std::string toml_value(const Key& key);

// A base of visitors that change no key and treat all types of keys alike.
class KeyVisitor : public config::Visitor {
 public:
  using config::Visitor::integer;
  void quantity(std::string_view name, double& value, config::Dimension dimension,
                config::Range range, config::Note note) final;
  void vector(std::string_view name, Eigen::Vector3d& value, config::Dimension dimension,
              config::Range range, config::Note note) final;
  void integer(std::string_view name, std::int64_t& value, config::IntegerRange range,
               config::Note note) final;
  void boolean(std::string_view name, bool& value, config::Note note) final;
  void text(std::string_view name, std::string& value, config::Note note) final;
  void file(std::string_view name, config::File& file, config::Note note) final;
  void choice_index(std::string_view name, std::size_t& index,
                    const std::vector<std::string_view>& names, config::Note note) final;

 protected:
  virtual void key(std::string_view name, const Key& key, const config::Note& note) = 0;
};

}  // namespace hvp::scenario
