#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "app/scenario/document.h"
#include "models/config/declaration.h"

namespace hvp::scenario {

// A file as the scenario writes it -> one that can be opened. Throws SourceError, of the line of
// `key`, where it is missing or no regular file.
std::filesystem::path openable_file(const Document& document, std::string_view key,
                                    const std::string& path_in_scenario);

// Turns every file parameter from the scenario's words into a path that can be opened. Call it
// after the resolved scenario is written, which keeps the words. Throws SourceError where a
// file is missing or no regular one.
class FileResolver : public config::Visitor {
 public:
  explicit FileResolver(const Document& document) : document_(document) {}

  using config::Visitor::integer;
  void quantity(std::string_view, double&, config::Dimension, config::Range,
                config::Note) override {}
  void vector(std::string_view, Eigen::Vector3d&, config::Dimension, config::Range,
              config::Note) override {}
  void integer(std::string_view, std::int64_t&, config::IntegerRange, config::Note) override {}
  void boolean(std::string_view, bool&, config::Note) override {}
  void text(std::string_view, std::string&, config::Note) override {}
  void file(std::string_view name, std::string& path, config::Note) override;
  void choice_index(std::string_view, std::size_t&, const std::vector<std::string_view>&,
                    config::Note) override {}

 protected:
  void begin_table(std::string_view name, config::Note) override { enter(name); }
  void end_table() override { path_.pop_back(); }
  bool begin_effect(std::string_view name, bool& present, config::Note) override;
  void end_effect() override { path_.pop_back(); }
  bool begin_list(std::string_view name, std::size_t&, config::Note) override;
  void begin_item(std::size_t index) override;
  void end_item() override { path_.pop_back(); }
  void end_list() override { path_.pop_back(); }

 private:
  void enter(std::string_view name);

  const Document& document_;
  std::vector<std::string> path_ = {""};
};

template <class Root>
void resolve_files(const Document& document, Root& root) {
  FileResolver resolver(document);
  resolver.visit(root);
}

}  // namespace hvp::scenario
