#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "app/scenario/tree.h"
#include "models/config/input_error.h"

namespace hvp::scenario {

// An error in a scenario or in what --set changed. what() is the complete line:
// "scenarios/x.toml:12: solver.iteratons: unknown key; did you mean "iterations"?"
class SourceError : public InputError {
 public:
  SourceError(std::string key, const std::string& line) : InputError(std::move(key), line) {}
  explicit SourceError(const std::string& line) : InputError(line) {}
};

// A scenario as a tree: its text, laid over its base and its includes, with the overrides of the
// command line applied. The document also knows which line or override gave each key.
//
// `base = "other.toml"` at the top names another scenario; this file then states only the
// differences. Tables are merged key by key, lists are replaced as a whole, and `effect = false`
// removes an effect of the base. A base may have a base itself.
//
// `include = "fitted.toml"`, or a list of such names, adds files of a few keys. They lie over the
// base and under the file's own keys, a later file of the list over an earlier one. An included
// file may have a base and includes itself. A path in any of these files is relative to the folder
// of that file.
//
// An override is KEY=VALUE. KEY is a dotted key; items of a list are written as key[0].name, and
// the index one past the last item appends an item. VALUE is a TOML value; anything else ("2 ms", a
// bare word) is taken as text. An override replaces the file's value, even a whole table, and
// creates missing tables on its way. `effect=false` removes an effect, and `effect=true` adds it
// with its defaults. An override that chooses another kind (mesh.shape, coefficient_format) drops
// the file's keys that belong to the old kind.
class Document {
 public:
  // Reads a regular file of at most 1 MiB. `includes` are laid over the scenario, a later file over
  // an earlier one. Throws SourceError if a file is missing, not a regular file, unreadable, empty,
  // too large, not UTF-8 or not TOML, if bases or includes form a cycle, and for a malformed
  // override.
  static Document load(const std::filesystem::path& file,
                       const std::vector<std::string>& overrides = {},
                       const std::vector<std::filesystem::path>& includes = {});
  // Reads the scenario from `text`. Errors name `file_name`, and relative paths start from its
  // folder.
  static Document parse(std::string_view text, const std::filesystem::path& file_name,
                        const std::vector<std::string>& overrides = {});
  // Makes a document of overrides alone, for a command without a scenario. Its errors name no file.
  static Document of_overrides(const std::vector<std::string>& overrides);

  // Lays the document's table `table`, which is there ("device", "probe[1].device"), over the same
  // table of another text or file, as over a base. Throws SourceError as load() does.
  void put_text_under(std::string_view table, std::string_view text,
                      const std::filesystem::path& file_name);
  void put_file_under(std::string_view table, const std::filesystem::path& file);

  const Node& root() const { return root_; }
  // The node of a key, or null.
  const Node* find(std::string_view key) const;

  // Converts a path that stands at `key`, and is relative to the folder of the file with that key,
  // into one relative to the program's working folder. A path of an override is relative to the
  // working folder already; where it is not there, to the scenario's.
  std::filesystem::path resolve(std::string_view key, const std::string& path_in_scenario) const;

  // The prefix of an error message about `key`: "scenarios/x.toml:12: object.mesh.nodes: ". The
  // prefix names the line of the nearest enclosing table if the key has its default value, and
  // "--set object.mesh.nodes=9: " if an override gave the key.
  std::string locate(std::string_view key) const;
  // Adds that prefix to an error that a model throws about a value. A SourceError has it already.
  SourceError complete(const InputError& error) const;

  // Returns the prefix for a node whose origin is known.
  std::string locate(const Origin& origin, std::string_view key) const;

 private:
  struct Override {
    std::string key;
    std::string text;  // KEY=VALUE
  };

  // A file that another file names as its base or as an include.
  struct Named {
    std::string key;
    Node text;
  };
  // The files on the way from the scenario to a file, as indices of files_.
  using Chain = std::vector<std::size_t>;

  static Document of_text(std::string_view text, const std::filesystem::path& file_name,
                          const std::vector<std::string>& overrides,
                          const std::vector<std::filesystem::path>& includes);
  // Lays the file's keys over those of all files below it. With `included` the file may consist of
  // comments alone.
  Node stack(std::string_view text, const std::filesystem::path& file, Chain above, bool included);
  // Removes `base` and `include` from the file's keys and returns the named files, the topmost
  // first.
  std::vector<Named> take_named(Node& own) const;
  Node stack_named(const Named& named, const Chain& above);
  const Node& at(std::string_view key) const;
  void apply(const std::string& text);

  // All files, the topmost first: includes of the command line, the scenario, its includes, its
  // base …
  std::vector<std::filesystem::path> files_;
  std::size_t scenario_ = 0;  // index of the scenario in files_
  Node root_;
  std::vector<Override> overrides_;
};

}  // namespace hvp::scenario
