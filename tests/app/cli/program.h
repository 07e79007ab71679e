#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

#include "tests/app/scratch_directory.h"

// The built `hvp`, used as a user does: started in a folder, with arguments.
namespace hvp::cli {

struct Ended {
  int status = -1;  // exit status; -1: ended by a signal
  int signal = 0;
  std::string out;
  std::string err;
};

// A started program; the destructor kills one that still runs.
class Program {
 public:
  // `input`: a file or pipe that is its standard input; empty: this process' own.
  Program(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
          const std::filesystem::path& input = {});
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void kill();  // as SIGKILL does: nothing is cleaned up
  void signal(int number);
  // The programs that it has started and that still run.
  std::vector<pid_t> children() const;
  pid_t pid() const { return pid_; }
  bool ended();
  Ended wait();
  // What it has printed so far.
  std::string out() const;

 private:
  void reap(int options);

  ScratchDirectory output_;  // its standard output and error, beside the folder
  pid_t pid_ = -1;
  bool reaped_ = false;
  int wait_status_ = 0;
};

Ended hvp(const std::filesystem::path& folder, const std::vector<std::string>& arguments);
// With a text as its standard input.
Ended hvp_reading(const std::string& input, const std::filesystem::path& folder,
                  const std::vector<std::string>& arguments);

std::string read(const std::filesystem::path& file);
void write(const std::filesystem::path& file, const std::string& text);
std::vector<std::string> lines(const std::string& text);
// Names in a folder, in order.
std::vector<std::string> names(const std::filesystem::path& folder);

// Letters and digits of a text, the rest as '-': a case's name for ctest.
std::string slug(const std::string& text);

// The project's scenarios/<name>.
std::filesystem::path scenario(const std::string& name);

// The arguments of a run of one of them into "out", with changes, of which only figures are wanted:
// nothing is drawn, traced or looked for.
std::vector<std::string> run_for_figures(const std::string& name,
                                         const std::vector<std::string>& changes);

// A small static scene that is touched within a few frames: a box of 60 nodes, pressed from its
// first tick.
extern const char* const kSmallScene;

}  // namespace hvp::cli
