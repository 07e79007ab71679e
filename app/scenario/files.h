#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "app/scenario/document.h"
#include "models/config/quiet_visitor.h"

namespace hvp::scenario {

// A file as the scenario writes it -> one that can be opened. Throws SourceError, of the line of
// `key`, where it is missing or no regular file.
std::filesystem::path openable_file(const Document& document, std::string_view key,
                                    const std::string& path_in_scenario);

// Gives every file parameter a path that can be opened. Throws SourceError where a file is missing
// or no regular one.
class FileResolver : public config::QuietVisitor {
 public:
  explicit FileResolver(const Document& document) : document_(document) {}

  void file(std::string_view name, config::File& file, config::Note) override;

 protected:
  void begin_table(std::string_view name, config::Note) override { enter(name); }
  void end_table() override { path_.pop_back(); }
  bool begin_effect(std::string_view name, bool& present, const config::EffectNote&) override;
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
