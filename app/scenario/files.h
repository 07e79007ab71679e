#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/scenario/document.h"
#include "models/config/effects.h"

namespace hvp::scenario {

// Returns a path that can be opened for a file named in the scenario. Throws SourceError with the
// line of `key` if the file is missing or not regular.
std::filesystem::path openable_file(const Document& document, std::string_view key,
                                    const std::string& path_in_scenario);

// Visits every file that a struct's parameters name, with its key. An absent effect has no files.
class FileVisitor : public config::QuietVisitor {
 public:
  void file(std::string_view name, config::File& file, config::Note) override;

 protected:
  virtual void found(const std::string& key, config::File& file) = 0;

  void begin_table(std::string_view name, config::Note) override { enter(name); }
  void end_table() override { path_.pop_back(); }
  bool begin_effect(std::string_view name, bool& present, const config::EffectNote&) override;
  void end_effect() override { path_.pop_back(); }
  bool begin_optional(std::string_view name, bool& present, config::Note) override {
    if (present) enter(name);
    return present;
  }
  void end_optional() override { path_.pop_back(); }
  bool begin_list(std::string_view name, std::size_t&, config::Note) override;
  void begin_item(std::size_t index) override;
  void end_item() override { path_.pop_back(); }
  void end_list() override { path_.pop_back(); }

 private:
  void enter(std::string_view name);

  std::vector<std::string> path_ = {""};
};

// Replaces every file parameter's path by one that can be opened. Throws SourceError if a file is
// missing or not regular.
class FileResolver : public FileVisitor {
 public:
  explicit FileResolver(const Document& document) : document_(document) {}

 protected:
  void found(const std::string& key, config::File& file) override;

 private:
  const Document& document_;
};

template <class Root>
void resolve_files(const Document& document, Root& root) {
  FileResolver resolver(document);
  resolver.visit(root);
}

// A file beside the scenario whose content affects the simulation.
struct NamedFile {
  std::string key;             // "object.mesh.surface"
  std::filesystem::path path;  // can be opened
};

class FileList : public FileVisitor {
 public:
  std::vector<NamedFile> take() { return std::move(files_); }

 protected:
  void found(const std::string& key, config::File& file) override {
    files_.push_back({key, file.path});
  }

 private:
  std::vector<NamedFile> files_;
};

// Lists the files of a struct whose paths are resolved, in the order of declaration.
template <class Root>
std::vector<NamedFile> files_of(const Root& root) {
  Root copy = root;  // declare() needs a mutable struct
  FileList list;
  list.visit(copy);
  return list.take();
}

}  // namespace hvp::scenario
