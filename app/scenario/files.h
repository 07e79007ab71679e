#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/scenario/document.h"
#include "models/config/quiet_visitor.h"

namespace hvp::scenario {

// A file as the scenario writes it -> one that can be opened. Throws SourceError, of the line of
// `key`, where it is missing or no regular file.
std::filesystem::path openable_file(const Document& document, std::string_view key,
                                    const std::string& path_in_scenario);

// Goes to every file that a struct's parameters name, with its key. Absent effects have none.
class FileVisitor : public config::QuietVisitor {
 public:
  void file(std::string_view name, config::File& file, config::Note) override;

 protected:
  virtual void found(const std::string& key, config::File& file) = 0;

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

  std::vector<std::string> path_ = {""};
};

// Gives every file parameter a path that can be opened. Throws SourceError where a file is missing
// or no regular one.
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

// A file beside a scenario that has a part in what it simulates.
struct NamedFile {
  std::string key;             // "object.mesh.surface"
  std::filesystem::path path;  // that can be opened
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

// Those of a struct whose files are resolved, in the order of declaration.
template <class Root>
std::vector<NamedFile> files_of(const Root& root) {
  Root copy = root;  // declare() takes what it may also fill
  FileList list;
  list.visit(copy);
  return list.take();
}

}  // namespace hvp::scenario
