#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "app/scenario/source_error.h"
#include "app/scenario/tree.h"

namespace hvp::scenario {

// A scenario's text as a tree, with what it includes and its base below it and the command line's
// overrides in place, and the way from a key back to the line that gave it.
//
// `base = "other.toml"` at the top names a scenario, by a path from this one's folder, of which
// this one states the differences: tables are merged key by key, lists are replaced as a whole, and
// `effect = false` takes an effect of the base out. A base may have one itself.
//
// `include = "fitted.toml"`, or a list of such names, does the same with files of a few keys: they
// lie over the base and under the file's own keys, a later one of the list over an earlier one. An
// included file may have a base and includes itself. A path in any of the files starts from the
// folder of that file.
//
// An override is KEY=VALUE: a dotted key (items of a list as key[0].name, from 0; the index one
// past the last appends) and a TOML value; what is not one ("2 ms", a bare word) is taken as
// text. It replaces what the file has there, whole tables too, and makes the tables on its way.
// `effect=false` takes an effect out and `effect=true` puts it in with its defaults. One that
// chooses another kind (mesh.shape, coefficient_format) leaves the file's keys of its own kind
// behind.
class Document {
 public:
  // Reads a regular file of at most 1 MiB. Throws SourceError: no such file, a folder or a device,
  // unreadable, empty, too large, not UTF-8 or not TOML, bases or includes that go round in a
  // circle, an override that is none. `includes` are laid over the scenario, a later one over an
  // earlier one.
  static Document load(const std::filesystem::path& file,
                       const std::vector<std::string>& overrides = {},
                       const std::vector<std::filesystem::path>& includes = {});
  // The same for a text; `file_name` is what errors call it, and its folder is where relative
  // paths start.
  static Document parse(std::string_view text, const std::filesystem::path& file_name,
                        const std::vector<std::string>& overrides = {});
  // Overrides alone, for a command that has no scenario; errors then name no file.
  static Document of_overrides(const std::vector<std::string>& overrides);

  // Lays what the document says in a table at the top over another text, or another file, of that
  // table's keys, as over a base. Throws SourceError as load() does.
  void put_text_under(std::string_view table, std::string_view text,
                      const std::filesystem::path& file_name);
  void put_file_under(std::string_view table, const std::filesystem::path& file);

  const Node& root() const { return root_; }

  // The path that `key` has -> one from the program's own folder: it starts from the folder of the
  // file that has the key.
  std::filesystem::path resolve(std::string_view key, const std::string& path_in_scenario) const;

  // What an error about `key` starts with: "scenarios/x.toml:12: object.mesh.nodes: ". A key
  // that stands at its default has the line of the nearest table around it; a key that an
  // override gave has "--set object.mesh.nodes=9: ".
  std::string locate(std::string_view key) const;
  // Completes what a model throws about a value that was read long before. The lines of
  // a SourceError are complete already.
  SourceError complete(const InputError& error) const;

  // The same prefix for a node that is at hand.
  std::string locate(const Origin& origin, std::string_view key) const;

 private:
  struct Override {
    std::string key;
    std::string text;  // KEY=VALUE
  };

  // A file that another one names: as its base, or among its includes.
  struct Named {
    std::string key;
    Node text;
  };
  // Those from the scenario down to a file, as indices of files_.
  using Chain = std::vector<std::size_t>;

  static Document of_text(std::string_view text, const std::filesystem::path& file_name,
                          const std::vector<std::string>& overrides,
                          const std::vector<std::filesystem::path>& includes);
  // The file's keys over those of all files below it.
  // `included`: it may consist of comments.
  Node stack(std::string_view text, const std::filesystem::path& file, Chain above, bool included);
  // What it names, and no longer has: that which counts most first.
  std::vector<Named> take_named(Node& own) const;
  Node stack_named(const Named& named, const Chain& above);
  const Node& at(std::string_view key) const;
  void apply(const std::string& text);

  // That which counts most first: includes of the command line, the scenario, its includes, its
  // base …
  std::vector<std::filesystem::path> files_;
  std::size_t scenario_ = 0;  // which of them it is
  Node root_;
  std::vector<Override> overrides_;
};

}  // namespace hvp::scenario
