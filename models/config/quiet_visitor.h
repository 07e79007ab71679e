#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "models/config/declaration.h"

namespace hvp::config {

// A visitor that does nothing, for one that is after a few things only: it goes into tables, and
// neither into effects nor into lists.
class QuietVisitor : public Visitor {
 public:
  using Visitor::integer;
  void quantity(std::string_view, double&, Dimension, Range, Note) override {}
  void vector(std::string_view, Eigen::Vector3d&, Dimension, Range, Note) override {}
  void integer(std::string_view, std::int64_t&, IntegerRange, Note) override {}
  void boolean(std::string_view, bool&, Note) override {}
  void text(std::string_view, std::string&, Note) override {}
  void file(std::string_view, File&, Note) override {}
  void choice_index(std::string_view, std::size_t&, const std::vector<std::string_view>&,
                    Note) override {}

 protected:
  void begin_table(std::string_view, Note) override {}
  void end_table() override {}
  bool begin_effect(std::string_view, bool&, const EffectNote&) override { return false; }
  void end_effect() override {}
  bool begin_list(std::string_view, std::size_t&, Note) override { return false; }
  void begin_item(std::size_t) override {}
  void end_item() override {}
  void end_list() override {}
};

}  // namespace hvp::config
