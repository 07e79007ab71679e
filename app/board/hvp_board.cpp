#include "app/board/hvp_board.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "app/board/board_bus.h"
#include "app/board/fault_words.h"
#include "app/board/outside_board.h"
#include "app/board/program_place.h"
#include "app/board/stop_points.h"
#include "app/record/recorder.h"
#include "app/results/board_records.h"
#include "app/results/results_folder.h"
#include "app/scene/loaded_scenario.h"
#include "vp/bus/weak_memory.h"
#include "vp/frame/ledger.h"
#include "vp/function/driver_rules.h"
#include "vp/function/outside_host.h"

using hvp::vp::Command;
using Space = hvp::vp::OutsideHost::Space;
using hvp::vp::Picoseconds;

// The last finished job.
class LastJob : public hvp::vp::FrameObserver {
 public:
  void closed(const hvp::vp::Frame& frame, const hvp::vp::CriticalPath& path) override {
    const auto ps = [](Picoseconds time) { return static_cast<std::uint64_t>(time); };
    job = {.number = static_cast<std::uint64_t>(frame.number),
           .begin_ps = ps(frame.born),
           .end_ps = ps(frame.born + frame.latency()),
           .host_ps = ps(path.time(hvp::vp::Part::host)),
           .bus_ps = ps(path.time(hvp::vp::Part::bus)),
           .fpga_ps = ps(path.time(hvp::vp::Part::fpga)),
           .status = frame.status};
  }

  std::optional<hvp_board_job> job;
};

// What the program maps has its stores in order as they are made visible.
class WeakMaps : public hvp::vp::MemoryObserver {
 public:
  WeakMaps(hvp::vp::HostMemory& memory, std::int64_t seed) : order(memory, seed) {
    memory.order_by(&order);
    memory.observe(*this);
  }
  void mapped(std::uint64_t address, std::uint64_t bytes, bool /*writable*/) override {
    order.map(address, bytes);
  }
  void unmapped(std::uint64_t address, std::uint64_t bytes) override {
    order.unmap_all(address, bytes);
  }

  hvp::vp::WeakMemory order;
};

struct hvp_board {
  hvp_board(const hvp::app::LoadedScenario& loaded, const hvp::vp::PlatformSettings& settings,
            const hvp_board_options& options)
      : scenario(loaded.scenario),
        trace(traced(options.trace)),
        record(recorded(options.record, loaded)),
        function(settings, watched(options.check)),
        bus(function, settings.transfer) {
    function.ledger().add_observer(last_job);
    if (trace != nullptr) trace->watch(function.accelerator());
    if (rules) {
      rules->locate(hvp::app::own_stack, hvp::app::name_place);
      hvp::app::watch_driver(*rules, function);
    }
    if (record != nullptr) record->watch(function);
    const hvp::app::Scenario& s = scenario;
    if (s.guest && s.guest->memory_order == hvp::host::GuestCosts::MemoryOrder::weak &&
        function.memory() != nullptr) {
      weak.emplace(*function.memory(), s.seed);
    }
    bus.enumerate();
  }

  static std::unique_ptr<hvp::results::RegisterTrace> traced(const char* folder) {
    if (folder == nullptr) return nullptr;
    hvp::results::create_folder(folder, "hvp_board_options.trace");
    return std::make_unique<hvp::results::RegisterTrace>(folder);
  }

  // Who sees the accesses; who watches the driver passes them on.
  hvp::vp::AccessObserver* watched(bool check) {
    hvp::vp::AccessObserver* const last = trace.get();
    return check ? &rules.emplace(last) : last;
  }
  static std::unique_ptr<hvp::record::RecordFile> recorded(
      const char* file, const hvp::app::LoadedScenario& scenario) {
    if (file == nullptr) return nullptr;
    return std::make_unique<hvp::record::RecordFile>(file, "hvp_board_options.record",
                                                     hvp::record::Layer::program, scenario);
  }

  void wait_for_writes() {
    std::array<std::uint8_t, 4> ignored{};
    function.host().access(Command::read, 0, ignored, hvp::vp::OutsideHost::Space::configuration);
  }

  hvp::app::Scenario scenario;
  LastJob last_job;
  std::unique_ptr<hvp::results::RegisterTrace> trace;
  std::optional<hvp::vp::DriverRules> rules;
  std::unique_ptr<hvp::record::RecordFile> record;
  hvp::vp::BoardFunction function;
  std::optional<WeakMaps> weak;
  hvp::app::BoardBus bus;
  std::optional<hvp::app::StopPoints> stops;
  std::vector<hvp::vp::DriverFinding> findings;  // as they were copied last
};

namespace {

bool a_board_was_open = false;

// SystemC's messages such as "Simulation stopped by user" are suppressed. Standard output is the
// program's own: warnings go to stderr, one line each, without a date.
void be_quiet() {
  auto log =
      std::make_shared<spdlog::logger>("hvp", std::make_shared<spdlog::sinks::stderr_sink_st>());
  log->set_pattern("%l: %v");
  spdlog::set_default_logger(std::move(log));
  sc_core::sc_report_handler::set_actions("/OSCI/SystemC", sc_core::SC_INFO,
                                          sc_core::SC_DO_NOTHING);
}

std::unique_ptr<hvp_board> open_board(const char* scenario, const hvp_board_options& options) {
  if (scenario == nullptr) throw std::invalid_argument("hvp_board_open: no scenario file");
  if (a_board_was_open) {
    throw std::invalid_argument("hvp_board_open: a process has one board, and it had one");
  }
  hvp::app::ScenarioSource source;
  source.scenario = scenario;
  for (std::size_t i = 0; i < options.override_count; ++i) {
    source.overrides.emplace_back(options.overrides[i]);
  }
  be_quiet();
  const hvp::app::LoadedScenario loaded = hvp::app::load_untitled(source);
  const hvp::vp::PlatformSettings settings = hvp::app::outside_board(loaded);
  a_board_was_open = true;
  return std::make_unique<hvp_board>(loaded, settings, options);
}

// Catches exceptions of the C++ parts, so that no C frame is unwound.
template <class Result, class Action>
Result caught(Result otherwise, const Action& action) noexcept {
  try {
    return action();
  } catch (...) {
    return otherwise;
  }
}

std::span<std::uint8_t> bytes_of(std::uint32_t& word) {
  return {reinterpret_cast<std::uint8_t*>(&word), sizeof word};
}

// Gives a file that was asked for its name.
template <class Written>
void finish(Written* written) {
  if (written == nullptr) return;
  try {
    written->finish();
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
  }
}

void say(std::string_view what, char* why, std::size_t why_bytes) {
  if (why == nullptr || why_bytes == 0) return;
  const std::size_t length = std::min(what.size(), why_bytes - 1);
  std::memcpy(why, what.data(), length);
  why[length] = '\0';
}

std::string_view text_of(const char* text) { return text == nullptr ? "" : text; }

// Makes a change that may be refused, and says why in a line.
template <class Change>
bool told(char* why, std::size_t why_bytes, std::string_view call, const Change& change) noexcept {
  say("", why, why_bytes);
  try {
    change();
    return true;
  } catch (const std::exception& e) {
    say(fmt::format("{}: {}", call, e.what()), why, why_bytes);
  } catch (...) {
    say("failed", why, why_bytes);
  }
  return false;
}

}  // namespace

hvp_board* hvp_board_open(const char* scenario, const hvp_board_options* options, char* why,
                          std::size_t why_bytes) {
  say("", why, why_bytes);
  try {
    return open_board(scenario, options == nullptr ? hvp_board_options{} : *options).release();
  } catch (const std::exception& e) {
    say(e.what(), why, why_bytes);
  } catch (...) {
    say("hvp_board_open: failed", why, why_bytes);
  }
  return nullptr;
}

void hvp_board_close(hvp_board* board) {
  if (board != nullptr) {
    caught(false, [&] {
      hvp::app::warn_of_faults_that_never_struck(board->function);
      return true;
    });
  }
  if (board != nullptr) {
    finish(board->trace.get());
    finish(board->record.get());
  }
  delete board;
}

const hvp_bus* hvp_board_bus(hvp_board* board) { return &board->bus.bus(); }

bool hvp_board_map(hvp_board* board, std::uint64_t bus_address, void* memory, std::size_t bytes) {
  hvp::vp::HostMemory* const host = board->function.memory();
  if (host == nullptr || memory == nullptr) return false;
  return caught(false, [&] {
    host->map(bus_address, {static_cast<std::uint8_t*>(memory), bytes});
    return true;
  });
}

bool hvp_board_unmap(hvp_board* board, std::uint64_t bus_address, std::uint64_t bytes) {
  hvp::vp::HostMemory* const host = board->function.memory();
  return host != nullptr && host->unmap(bus_address, bytes);
}

void hvp_board_barrier(hvp_board* board) {
  if (board->weak) board->weak->order.barrier();
}

void hvp_board_read(hvp_board* board, std::uint64_t offset, void* data, std::size_t bytes) {
  caught(false, [&] {
    return board->function.host().access(Command::read, offset,
                                         {static_cast<std::uint8_t*>(data), bytes});
  });
}

void hvp_board_write(hvp_board* board, std::uint64_t offset, const void* data, std::size_t bytes) {
  // A write only reads the data.
  auto* const words = const_cast<std::uint8_t*>(static_cast<const std::uint8_t*>(data));
  caught(false, [&] {
    return board->function.host().access(Command::write, offset, {words, bytes});
  });
}

std::uint32_t hvp_board_config_read(hvp_board* board, std::uint32_t offset, std::size_t bytes) {
  std::array<std::uint8_t, 4> data{};
  const std::span<std::uint8_t> part = std::span(data).first(std::min<std::size_t>(bytes, 4));
  caught(false, [&] {
    return board->function.host().access(Command::read, offset, part, Space::configuration);
  });
  std::uint32_t value = 0;
  for (std::size_t i = part.size(); i > 0; --i) value = value << 8U | part[i - 1];
  return value;
}

void hvp_board_config_write(hvp_board* board, std::uint32_t offset, std::uint32_t value,
                            std::size_t bytes) {
  std::array<std::uint8_t, 4> data{};
  const std::span<std::uint8_t> part = std::span(data).first(std::min<std::size_t>(bytes, 4));
  for (std::size_t i = 0; i < part.size(); ++i) part[i] = static_cast<std::uint8_t>(value >> 8 * i);
  caught(false, [&] {
    return board->function.host().access(Command::write, offset, part, Space::configuration);
  });
}

std::uint32_t hvp_board_table_read(hvp_board* board, std::uint32_t offset) {
  std::uint32_t value = 0;
  caught(false, [&] {
    return board->function.host().access(Command::read, offset, bytes_of(value),
                                         Space::message_table);
  });
  return value;
}

void hvp_board_table_write(hvp_board* board, std::uint32_t offset, std::uint32_t value) {
  caught(false, [&] {
    return board->function.host().access(Command::write, offset, bytes_of(value),
                                         Space::message_table);
  });
}

std::uint64_t hvp_board_now_ps(const hvp_board* /*board*/) {
  return static_cast<std::uint64_t>(hvp::vp::now_ps());
}

bool hvp_board_next_event_ps(const hvp_board* /*board*/, std::uint64_t* when_ps) {
  const std::optional<Picoseconds> next = hvp::vp::BoardSide::next_event();
  if (next) *when_ps = static_cast<std::uint64_t>(*next);
  return next.has_value();
}

bool hvp_board_run_until_ps(hvp_board* board, std::uint64_t time_ps) {
  // Eleven days, so that later times still fit into 64 bits.
  constexpr std::uint64_t kLatest = 1'000'000'000'000'000'000;
  if (time_ps > kLatest) return false;
  return caught(false, [&] {
    const bool reached = board->function.host().run_until(static_cast<Picoseconds>(time_ps));
    board->function.host().frames().looked();
    return reached;
  });
}

bool hvp_board_interrupt(hvp_board* board) { return board->bus.take_interrupt(); }

bool hvp_board_inject(hvp_board* board, const char* fault, char* why, std::size_t why_bytes) {
  return told(why, why_bytes, "hvp_board_inject", [&] {
    hvp::app::inject_fault(board->function, board->scenario, text_of(fault));
    if (board->record != nullptr) board->record->note_fault(text_of(fault));
  });
}

bool hvp_board_stop_at(hvp_board* board, const char* point, hvp_board_stopped stopped,
                       void* context, char* why, std::size_t why_bytes) {
  return told(why, why_bytes, "hvp_board_stop_at", [&] {
    if (stopped == nullptr) {
      if (board->stops && board->stops->remove(text_of(point))) return;
      throw std::invalid_argument("there is no such point to take away");
    }
    if (!board->stops) board->stops.emplace(board->function);
    board->stops->add(text_of(point), [board, stopped, context](const hvp::app::Stop& stop) {
      const hvp_board_stop told = {.point = stop.point.c_str(),
                                   .what = stop.what.c_str(),
                                   .time_ps = static_cast<std::uint64_t>(stop.time),
                                   .job = stop.job,
                                   .offset = stop.offset,
                                   .value = stop.value};
      board->function.host().hold_time();
      stopped(context, &told);
      board->function.host().release_time();
    });
  });
}

bool hvp_board_last_job(hvp_board* board, hvp_board_job* job) {
  return caught(false, [&] {
    // What was posted last may be under way yet, and the job with it.
    board->wait_for_writes();
    if (!board->function.ledger().holds()) board->function.host().frames().finish();
    if (board->last_job.job) *job = *board->last_job.job;
    return board->last_job.job.has_value();
  });
}

std::size_t hvp_board_findings(hvp_board* board, hvp_board_finding* findings, std::size_t room) {
  if (!board->rules) return 0;
  return caught(std::size_t{0}, [&] {
    board->wait_for_writes();
    board->rules->finish();
    board->findings = board->rules->report().findings;
    for (std::size_t i = 0; i < std::min(room, board->findings.size()); ++i) {
      const hvp::vp::DriverFinding& one = board->findings[i];
      findings[i] = {.rule = hvp::vp::name(one.rule).data(),
                     .what = one.what.c_str(),
                     .count = static_cast<std::uint64_t>(one.count),
                     .first_ps = static_cast<std::uint64_t>(one.first),
                     .job = one.job,
                     .access = static_cast<std::uint64_t>(one.access),
                     .program_counter = one.program_counter,
                     .function = one.function.c_str()};
    }
    return board->findings.size();
  });
}

// SystemC's library has a main of its own that calls sc_main; it is not used.
int sc_main(int /*argc*/, char** /*argv*/) { return 1; }
