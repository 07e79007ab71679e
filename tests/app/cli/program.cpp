#include "tests/app/cli/program.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/app/scratch_directory.h"

namespace hvp::cli {

namespace {
namespace fs = std::filesystem;

void redirect(const fs::path& file, int descriptor) {
  const int opened = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (opened < 0 || ::dup2(opened, descriptor) < 0) ::_exit(126);
}
}  // namespace

Program::Program(const fs::path& folder, const std::vector<std::string>& arguments,
                 const fs::path& input) {
  std::vector<std::string> words = {HVP_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_ = ::fork();
  if (pid_ < 0) throw std::runtime_error("fork failed");
  if (pid_ == 0) {
    if (::chdir(folder.c_str()) != 0) ::_exit(126);
    if (!input.empty()) {
      const int opened = ::open(input.c_str(), O_RDONLY);
      if (opened < 0 || ::dup2(opened, STDIN_FILENO) < 0) ::_exit(126);
      ::close(opened);
    }
    redirect(output_.path() / "out", STDOUT_FILENO);
    redirect(output_.path() / "err", STDERR_FILENO);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
}

Program::~Program() {
  if (!reaped_) {
    kill();
    reap(0);
  }
}

void Program::kill() {
  if (!reaped_) ::kill(pid_, SIGKILL);
}

void Program::signal(int number) {
  if (!reaped_) ::kill(pid_, number);
}

std::vector<pid_t> Program::children() const {
  std::ifstream file("/proc/" + std::to_string(pid_) + "/task/" + std::to_string(pid_) +
                     "/children");
  return {std::istream_iterator<pid_t>(file), std::istream_iterator<pid_t>()};
}

void Program::reap(int options) {
  if (!reaped_) reaped_ = ::waitpid(pid_, &wait_status_, options) == pid_;
}

bool Program::ended() {
  reap(WNOHANG);
  return reaped_;
}

Ended Program::wait() {
  reap(0);
  Ended ended;
  if (WIFEXITED(wait_status_)) ended.status = WEXITSTATUS(wait_status_);
  if (WIFSIGNALED(wait_status_)) ended.signal = WTERMSIG(wait_status_);
  ended.out = read(output_.path() / "out");
  ended.err = read(output_.path() / "err");
  return ended;
}

std::string Program::out() const {
  const fs::path file = output_.path() / "out";
  return fs::exists(file) ? read(file) : std::string();
}

Ended hvp(const fs::path& folder, const std::vector<std::string>& arguments) {
  return Program(folder, arguments).wait();
}

Ended hvp_reading(const std::string& input, const fs::path& folder,
                  const std::vector<std::string>& arguments) {
  const ScratchDirectory place;
  write(place.path() / "input", input);
  return Program(folder, arguments, place.path() / "input").wait();
}

std::string read(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw std::runtime_error("cannot read " + file.string());
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void write(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> found;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) found.push_back(line);
  return found;
}

std::vector<std::string> names(const fs::path& folder) {
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator(folder)) {
    found.push_back(entry.path().filename().string());
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::string slug(const std::string& text) {
  std::string name;
  for (const char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (plain) name += c;
    if (!plain && !name.empty() && name.back() != '-') name += '-';
  }
  return name;
}

fs::path scenario(const std::string& name) { return fs::path(HVP_SCENARIOS) / name; }

std::vector<std::string> run_for_figures(const std::string& name,
                                         const std::vector<std::string>& changes) {
  std::vector<std::string> arguments = {"run", scenario(name).string(), "--out", "out"};
  const auto set = [&arguments](const std::string& change) {
    arguments.emplace_back("--set");
    arguments.push_back(change);
  };
  for (const char* none : {"output.pictures=false", "output.remedies=false",
                           "output.deformation_every_frames=0", "output.trace_frames=0"}) {
    set(none);
  }
  for (const std::string& change : changes) set(change);
  return arguments;
}

const char* const kSmallScene = R"(title = "A small box"
frames = 40
contact.kind = "node"
[budget]
period = "2 ms"

[object.mesh]
shape = "box"
size = ["20 mm", "20 mm", "20 mm"]
nodes = 60

[object.material]
young_modulus = "10 kPa"
poisson_ratio = 0.3

[[object.anchor]]
kind = "lowest-fraction"
fraction = 0.2

[solver]
iterations = 20

[accelerator]
device = "EP2S60"

[probe]
start = ["1 mm", "1 mm", "10 mm"]

[[probe.motion]]
phase = "press"
to = ["1 mm", "1 mm", "8 mm"]
duration = "60 ms"

[reference]

[output]
deformation_every_frames = 10
pictures = false
)";

}  // namespace hvp::cli
