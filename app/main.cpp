#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <systemc>
#include <utility>

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "app/commands/commands.h"
#include "app/results/part_files.h"
#include "models/config/input_error.h"

namespace {

// Warnings of the run go to stderr, a line each, without a date that would differ between runs.
void set_up_log() {
  auto log =
      std::make_shared<spdlog::logger>("hvp", std::make_shared<spdlog::sinks::stderr_sink_st>());
  log->set_pattern("%l: %v");
  spdlog::set_default_logger(std::move(log));
}

}  // namespace

// SystemC's library has a main of its own that calls this; it is not used.
int sc_main(int /*argc*/, char** /*argv*/) { return hvp::app::kFailed; }

// LeakSanitizer reads the stacks of a program that ends and trips over the guard pages between
// SystemC's, now and then. What globals and the heap do not hold is found all the same.
#ifdef __SANITIZE_ADDRESS__
extern "C" const char* __lsan_default_options() { return "use_stacks=0"; }
#endif

int main(int argc, char** argv) {
  // Read by VTK, whose header for the same call is no C++20: its writer would start TBB's threads
  // for the ranges of a few thousand values, which takes 8 ms.
  setenv("VTK_SMP_BACKEND_IN_USE", "Sequential", 0);
  set_up_log();
  hvp::results::end_cleanly_when_interrupted();
  // "Simulation stopped by user" is how every run ends.
  sc_core::sc_report_handler::set_actions("/OSCI/SystemC", sc_core::SC_INFO,
                                          sc_core::SC_DO_NOTHING);
  try {
    const int status = hvp::app::parse_and_run(argc, argv);
    // A report that nobody got is not a run that went well.
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      throw std::runtime_error("cannot write to standard output");
    }
    return status;
  } catch (const hvp::InputError& e) {
    hvp::app::end_progress(false);
    hvp::app::complain(e.what());
    return hvp::app::kWrongInput;
  } catch (const sc_core::sc_report& e) {
    // What a process threw, in the kernel's wrapping of several lines.
    hvp::app::end_progress(false);
    hvp::app::complain(std::string("hvp: ") + e.get_msg());
    return hvp::app::kFailed;
  } catch (const std::exception& e) {
    hvp::app::end_progress(false);
    hvp::app::complain(std::string("hvp: ") + e.what());
    return hvp::app::kFailed;
  }
}
