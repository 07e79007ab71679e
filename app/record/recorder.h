#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

#include "app/record/record.h"
#include "app/results/part_files.h"
#include "app/scene/loaded_scenario.h"
#include "vp/bus/host_memory.h"
#include "vp/function/outside_host.h"

namespace hvp::record {

// Makes entries of all that passes between a host and the board's function.
class Recorder : public vp::OutsideHost::Observer, public vp::MemoryObserver {
 public:
  using Sink = std::function<void(const Entry&)>;

  // `sink` gets each entry at its time; its data are valid during the call.
  explicit Recorder(Sink sink) : sink_(std::move(sink)) {}

  // From now on. Keeps references, also in `function`.
  void watch(vp::BoardFunction& function);
  // An interrupt that a replay has awaited did not come.
  void note_missing() { put({.kind = Kind::missing}); }
  // The program has asked for a fault, and was not refused.
  void note_fault(std::string_view words);
  // Nothing more follows.
  void note_end() { put({.kind = Kind::end}); }

  // OutsideHost::Observer
  void asked(const vp::OutsideHost::Access& access) override;
  void ended(const vp::OutsideHost::Access& access) override;
  void message(const vp::ConfigSpace::Message& message) override;
  void line(bool up) override;
  // MemoryObserver
  void mapped(std::uint64_t address, std::uint64_t bytes, bool writable) override;
  void unmapped(std::uint64_t address, std::uint64_t bytes) override;
  void moved(bool read, std::uint64_t address, std::span<const std::uint8_t> data,
             bool answered) override;

 protected:
  std::uint64_t accesses_ended() const { return ends_; }
  std::uint64_t interrupts() const { return interrupts_; }

 private:
  // Adds the time and, where there are data, their number.
  void put(Entry entry);
  void put_range(Kind kind, std::uint8_t flags, std::uint64_t address, std::uint64_t bytes);

  Sink sink_;
  std::uint64_t ends_ = 0;
  std::uint64_t interrupts_ = 0;
};

// A record that is written while the simulation runs, of every host but that of hvp run. Until
// finish() it is <file>.part, in which every access that has ended is whole even where the process
// is killed.
class RecordFile {
 public:
  // Creates the file and the folder that it is in. `option` is how the user has named it. Throws
  // InputError where the file cannot be there, std::runtime_error where it cannot be created.
  RecordFile(const std::filesystem::path& file, std::string_view option, Layer layer,
             const app::LoadedScenario& scenario);

  void watch(vp::BoardFunction& function) { recorder_.watch(function); }
  void note_fault(std::string_view words) { recorder_.note_fault(words); }
  // Throws std::runtime_error where the disk did not take all of it.
  void finish();

 private:
  results::PartStream stream_;
  Recorder recorder_;
};

}  // namespace hvp::record
