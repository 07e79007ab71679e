#include "app/linux/kernel_stack.h"

#include <chrono>
#include <cstdint>
#include <fstream>
#include <optional>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <sys/ptrace.h>
#include <sys/uio.h>
#include <sys/user.h>
#include <sys/wait.h>

#include "models/files/elf_functions.h"

namespace hvp::guest {

namespace {

// A kernel's stack, 4 pages (CONFIG_KERNEL_STACK_ORDER), at a multiple of its size.
constexpr std::uint64_t kStackBytes = 16384;
// Kept of a long stack: what the processor does, and what for.
constexpr std::size_t kInnermost = 8;
constexpr std::size_t kOutermost = 6;
constexpr std::chrono::milliseconds kTimeToStop{500};

bool wait_until_stopped(pid_t process) {
  const auto latest = std::chrono::steady_clock::now() + kTimeToStop;
  while (std::chrono::steady_clock::now() < latest) {
    int status = 0;
    const pid_t changed = waitpid(process, &status, WNOHANG | __WALL);
    if (changed != 0) return changed == process && WIFSTOPPED(status);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

struct StoppedProcess {
  std::uint64_t instruction = 0;
  std::vector<std::uint64_t> stack;  // from its end to the stack's begin
};

std::optional<StoppedProcess> look_into(pid_t process) {
  if (ptrace(PTRACE_SEIZE, process, nullptr, nullptr) != 0) return std::nullopt;
  std::optional<StoppedProcess> seen;
  user_regs_struct registers{};
  if (ptrace(PTRACE_INTERRUPT, process, nullptr, nullptr) == 0 && wait_until_stopped(process) &&
      ptrace(PTRACE_GETREGS, process, nullptr, &registers) == 0) {
    seen.emplace();
    seen->instruction = registers.rip;
    const std::uint64_t bytes = kStackBytes - registers.rsp % kStackBytes;
    seen->stack.resize(bytes / sizeof(std::uint64_t));
    const iovec here{seen->stack.data(), seen->stack.size() * sizeof(std::uint64_t)};
    const iovec there{reinterpret_cast<void*>(registers.rsp), here.iov_len};  // NOLINT
    const ssize_t read = process_vm_readv(process, &here, 1, &there, 1, 0);
    seen->stack.resize(read < 0 ? 0 : static_cast<std::size_t>(read) / sizeof(std::uint64_t));
  }
  ptrace(PTRACE_DETACH, process, nullptr, nullptr);
  return seen;
}

// What an address outside the kernel's own functions belongs to: a library of this machine, or what
// the kernel has put into its memory itself.
std::string place_of(pid_t process, std::uint64_t address) {
  std::ifstream maps(fmt::format("/proc/{}/maps", process));
  std::string line;
  while (std::getline(maps, line)) {
    std::istringstream words(line);
    std::uint64_t begin = 0;
    std::uint64_t end = 0;
    char dash = 0;
    words >> std::hex >> begin >> dash >> end;
    if (address < begin || address >= end) continue;
    std::string name = line.substr(line.find_last_of("/ ") + 1);
    if (name.find(".so") != std::string::npos) return name;
  }
  return "a module";
}

}  // namespace

std::vector<std::string> kernel_stack(pid_t process, const std::filesystem::path& kernel) {
  const std::optional<StoppedProcess> seen = look_into(process);
  if (!seen) return {};
  const std::vector<files::Function> functions = files::functions_of(kernel);
  std::vector<std::string> names;
  const files::Function* inside = files::function_at(functions, seen->instruction);
  names.push_back(inside != nullptr ? inside->name : place_of(process, seen->instruction));
  for (const std::uint64_t word : seen->stack) {
    const files::Function* function = files::function_at(functions, word);
    // What is called from returns behind its begin.
    if (function == nullptr || word == function->begin || function->name == names.back()) continue;
    names.push_back(function->name);
  }
  if (names.size() > kInnermost + kOutermost) {
    const auto first = names.begin() + kInnermost;
    *first = "...";
    names.erase(first + 1, names.end() - kOutermost);
  }
  return names;
}

bool is_traced(pid_t process) {
  std::ifstream status(fmt::format("/proc/{}/status", process));
  constexpr std::string_view kTracer = "TracerPid:";
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(kTracer)) {
      return std::atoi(line.c_str() + kTracer.size()) != 0;
    }
  }
  return false;
}

}  // namespace hvp::guest
