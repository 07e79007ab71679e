#include "app/linux/guest.h"

#include <algorithm>
#include <array>
#include <csignal>
#include <fstream>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/linux/calendar.h"
#include "app/linux/guest_error.h"
#include "app/linux/kernel_stack.h"
#include "app/results/number_text.h"

namespace hvp::guest {

namespace {

// CONFIG_UML_PCI_OVER_VIRTIO_DEVICE_ID of driver/linux/kernel/base.config.
constexpr int kDeviceId = 1234;
// A kernel without a timer that nothing has woken for this time counts as asleep for ever.
constexpr vp::Picoseconds kLongestSleep = vp::Picoseconds{60} * 1'000'000'000'000;
// A wait that the guest's own timer ends after more than this is a sleep of its programs. The
// kernel itself waits for less: 1 µs to poll (udelay(1)) and 256 ns to read its clock.
constexpr std::uint64_t kSleep = 10'000;  // ns
constexpr std::string_view kStatusFile = "status";
// Follows the status if that is insmod's and not the script's (driver/linux/guest/init).
constexpr std::string_view kModule = "insmod";

}  // namespace

Guest::Guest(vp::BoardFunction& board, const GuestSettings& settings)
    : board_(board),
      kernel_(settings.kernel),
      calendar_socket_(folder_.path() / "calendar"),
      device_socket_(folder_.path() / "board"),
      process_({.kernel = settings.kernel,
                .arguments = arguments(settings),
                .folder = folder_.path(),
                .patience = settings.patience,
                .hold = settings.hold,
                .print = settings.print}),
      say_(settings.say),
      debugged_(settings.hold),
      system_call_ns_(settings.system_call_ns) {
  if (!settings.stop_at.empty()) stop_points_.emplace(board);
  for (const std::string& point : settings.stop_at) {
    stop_points_->add(point, [this](const app::Stop& stop) { this->stop(stop); });
  }
  if (settings.check_dma && board.memory() != nullptr) dma_check_.emplace(*board.memory());
  if (settings.weak_memory_seed && board.memory() != nullptr) {
    weak_memory_.emplace(*board.memory(), *settings.weak_memory_seed);
    board.memory()->order_by(&*weak_memory_);
  }
}

Guest::~Guest() {
  if (weak_memory_) board_.memory()->order_by(nullptr);
}

std::vector<std::string> Guest::arguments(const GuestSettings& settings) const {
  const std::string folder = folder_.path().string();
  std::vector<std::string> words = {
      "mem=" + settings.memory,
      "time-travel=ext:" + folder + "/calendar",
      fmt::format("virtio_uml.device={}/board:{}", folder, kDeviceId),
      // The files of the kernel itself, which would otherwise be in the user's home.
      "uml_dir=" + folder + "/",
      "umid=guest",
      "con0=fd:0,fd:1",
      // The page tables of programs at random addresses would differ each time.
      "norandmaps",
      "noreboot",
      "panic=-1",
  };
  if (!settings.initrd.empty()) {
    words.push_back("initrd=" + std::filesystem::absolute(settings.initrd).string());
  }
  if (!settings.script.empty()) {
    words.push_back("hvp.script=" + std::filesystem::absolute(settings.script).string());
  }
  words.push_back("hvp.status=" + (folder_.path() / kStatusFile).string());
  if (settings.system_call_ns > 0) {
    words.push_back(fmt::format("system_call_ns={}", settings.system_call_ns));
  }
  words.insert(words.end(), settings.arguments.begin(), settings.arguments.end());
  return words;
}

const BoardDevice::Counts& Guest::counts() const {
  static const BoardDevice::Counts kNone;
  return device_ ? device_->counts() : kNone;
}

std::optional<DmaCheck::Counts> Guest::dma() const {
  return dma_check_ ? dma_check_->counts() : std::nullopt;
}

std::optional<vp::WeakMemory::Counts> Guest::memory_order() const {
  const bool tells = weak_memory_ && device_ && device_->tells_of_order();
  return tells ? std::optional(weak_memory_->counts()) : std::nullopt;
}

Guest::End Guest::run() {
  End end;
  try {
    while (!stopped_) {
      if (calendar_.connected() && calendar_.waiting()) {
        const auto began = std::chrono::steady_clock::now();
        sleep();
        process_.forgive(std::chrono::steady_clock::now() - began);
      } else {
        serve();
      }
    }
  } catch (const GuestGone&) {
    if (!stopped_) judge_end();
  } catch (const GuestInterrupted&) {
    end.interrupted = true;
  }
  end.stopped = stopped_;
  std::ifstream file(folder_.path() / kStatusFile);
  std::string of;
  if (int status = 0; file >> status) {
    file >> of;
    (of == kModule ? end.module_status : end.script_status) = status;
  }
  return end;
}

std::string Guest::hang_text() const {
  std::string text =
      fmt::format("the guest at {} us of simulated time", results::microseconds(vp::now_ps()));
  const std::vector<std::string> stack = kernel_stack(process_.number(), kernel_);
  if (!stack.empty()) text += fmt::format(": its processor is in {}", fmt::join(stack, " < "));
  return text + "\n  " + board_text();
}

std::string Guest::board_text() const {
  const vp::RegisterBank& bank = board_.accelerator().bank();
  std::string state = "idle";
  if (bank.get(vp::field::kStatusError) != 0) {
    state = fmt::format("error {}", bank.get(vp::field::kStatusErrorCode));
  } else if (bank.get(vp::field::kStatusBusy) != 0) {
    state = "busy";
  } else if (bank.get(vp::field::kStatusDone) != 0) {
    state = "done";
  }
  std::string text = fmt::format("the board: {}", state);
  if (!device_) return text + "; no access was made";
  if (const auto& job = device_->recent().job()) {
    text += fmt::format("; its last job, number {} of the run, was asked for at {} us", job->number,
                        results::microseconds(job->started));
  }
  return text + "\n  the last accesses to it:" + device_->recent().text(bank);
}

// The guest stands still here: it waits for its access, or for simulated time.
void Guest::stop(const app::Stop& stop) {
  if (debugged_) {
    give_to_debugger(stop);
  } else if (!stopped_) {
    stopped_ = true;
    board_.host().frames().stop();
    say_(fmt::format("stopped: {}\n{}", stop.what, hang_text()));
  }
}

// The signal is the debugger's, who does not pass it on; the kernel would end by it.
void Guest::give_to_debugger(const app::Stop& stop) {
  if (is_traced(process_.number()) && kill(process_.number(), SIGINT) == 0) {
    say_("stopped: " + stop.what);
  } else {
    say_("not stopped, as no debugger has the kernel: " + stop.what);
  }
}

// Processes messages while the guest runs.
void Guest::serve() {
  std::vector<int> sources = {calendar_.connected() ? calendar_.number()
                                                    : calendar_socket_.number()};
  if (calendar_.connected())
    sources.push_back(device_ ? device_->number() : device_socket_.number());
  const std::size_t which = process_.wait_readable(sources);
  if (!calendar_.connected()) {
    calendar_ = Calendar(calendar_socket_.accept(process_));
  } else if (which == 0) {
    calendar_.serve(now_ns());
    if (calendar_.waiting()) told_ = false;
  } else if (!device_) {
    device_ = std::make_unique<BoardDevice>(
        board_.host(), board_.memory(),
        BoardDevice::Mappings{dma_check_ ? &*dma_check_ : nullptr,
                              weak_memory_ ? &*weak_memory_ : nullptr},
        calendar_, device_socket_.accept(process_));
  } else {
    device_->serve();
    process_.did_something();
    if (!first_access_ && device_->counts().reads + device_->counts().writes > 0) {
      first_access_ = vp::now_ps();
    }
  }
}

// Advances simulated time while the guest waits, until it wants to run or the board has something
// to report.
void Guest::sleep() {
  if (device_ && device_->settle()) told_ = true;
  const std::uint64_t wanted = calendar_.requested().value_or(Calendar::kNever);
  const bool has_timer = wanted < Calendar::kNever;
  const vp::Picoseconds latest = has_timer ? to_ps(wanted) : vp::now_ps() + kLongestSleep;
  const vp::Picoseconds due =
      device_ ? std::max(device_->due().value_or(latest), vp::now_ps()) : latest;
  const bool reached = board_.host().run_until(std::min(latest, due));
  if (device_) device_->advance();
  while (!whole_ns()) {
    board_.host().run_until(to_ps(now_ns()));
    if (device_) device_->advance();
  }
  if (!reached || due < latest) return;
  if (!has_timer) {
    throw GuestHung(
        fmt::format("the guest sleeps without a timer, and nothing of the board has "
                    "woken it for {} s of simulated time",
                    kLongestSleep / 1'000'000'000'000));
  }
  const std::uint64_t waited = wanted - calendar_.waits_since();
  // A system call of one microsecond cannot be distinguished from a failed one of a kernel without
  // the patch.
  if (system_call_ns_ > 0 && std::cmp_equal(waited, system_call_ns_)) {
    system_calls_take_time_ = true;
  }
  const bool slept = waited > kSleep;
  if (slept && !told_) board_.host().frames().woke(vp::now_ps());
  // A kernel that takes interrupts runs for its own ticks too; one that polls has looked.
  const bool polls = board_.accelerator().bank().get(vp::Register::interrupt_enable) == 0;
  if (polls) {
    board_.host().frames().looked();
  } else {
    board_.host().frames().ran();
  }
  calendar_.run(now_ns());
}

void Guest::judge_end() {
  const std::optional<int> status = process_.wait_for_end();
  if (process_.panic()) throw GuestError("the guest's kernel panicked: " + *process_.panic());
  if (!calendar_.connected()) {
    throw GuestError(
        "the guest's kernel ended before it asked for the time: expected one with "
        "UML_TIME_TRAVEL_SUPPORT, and --memory enough for it");
  }
  if (!status) throw GuestError("the guest's kernel has closed a connection and goes on");
  if (*status != 0) {
    throw GuestError(*status < 0 ? "the guest's kernel was killed by a signal"
                                 : fmt::format("the guest's kernel ended with status {}", *status));
  }
}

}  // namespace hvp::guest
