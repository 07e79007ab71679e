#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <systemc>
#include <utility>
#include <vector>

#include <tlm_utils/simple_initiator_socket.h>

#include "vp/frame/frame_tag.h"

namespace hvp::test {

// Simulated seconds in picoseconds, to write expected times with.
inline constexpr vp::Picoseconds kNs = 1'000;
inline constexpr vp::Picoseconds kUs = 1'000'000;
inline constexpr vp::Picoseconds kMs = 1'000'000'000;

// A master that runs a test's script in a process of its own and drives a target socket.
class Stimulus : public sc_core::sc_module {
 public:
  using Script = std::function<void(Stimulus&)>;

  Stimulus(const sc_core::sc_module_name& name, Script script)
      : sc_module(name), to_target("to_target"), script_(std::move(script)) {
    SC_HAS_PROCESS(Stimulus);
    SC_THREAD(run);
    set_stack_size(1 << 20);
  }

  tlm_utils::simple_initiator_socket<Stimulus> to_target;

  tlm::tlm_response_status write(std::uint64_t address, const void* data, std::size_t bytes,
                                 vp::Tag* tag = nullptr) {
    return transport(tlm::TLM_WRITE_COMMAND, address, const_cast<void*>(data), bytes, tag);
  }
  tlm::tlm_response_status read(std::uint64_t address, void* data, std::size_t bytes,
                                vp::Tag* tag = nullptr) {
    return transport(tlm::TLM_READ_COMMAND, address, data, bytes, tag);
  }
  // A board's read whose span is to have this phase.
  tlm::tlm_response_status read_as(vp::Phase phase, std::uint64_t address, void* data,
                                   std::size_t bytes, vp::Tag* tag) {
    return transport(tlm::TLM_READ_COMMAND, address, data, bytes, tag, phase);
  }
  void sleep(vp::Picoseconds time) { wait(vp::to_sc_time(time)); }
  void sleep_until(vp::Picoseconds time) { sleep(time - vp::now_ps()); }

 private:
  void run() { script_(*this); }

  tlm::tlm_response_status transport(tlm::tlm_command command, std::uint64_t address, void* data,
                                     std::size_t bytes, vp::Tag* tag,
                                     std::optional<vp::Phase> phase = std::nullopt) {
    tlm::tlm_generic_payload payload;
    vp::FrameTag extension;
    extension.phase = phase;
    extension.tag = tag;
    payload.set_extension(&extension);
    payload.set_command(command);
    payload.set_address(address);
    payload.set_data_ptr(static_cast<unsigned char*>(data));
    payload.set_data_length(static_cast<unsigned>(bytes));
    payload.set_streaming_width(static_cast<unsigned>(bytes));
    sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
    to_target->b_transport(payload, delay);
    if (delay != sc_core::SC_ZERO_TIME) wait(delay);
    payload.clear_extension(&extension);
    return payload.get_response_status();
  }

  Script script_;
};

// A process that runs a test's script without a socket of its own.
class Program : public sc_core::sc_module {
 public:
  using Script = std::function<void(Program&)>;

  Program(const sc_core::sc_module_name& name, Script script)
      : sc_module(name), script_(std::move(script)) {
    SC_HAS_PROCESS(Program);
    SC_THREAD(run);
    set_stack_size(1 << 20);
  }
  void sleep(vp::Picoseconds time) { wait(vp::to_sc_time(time)); }
  void sleep_until(vp::Picoseconds time) { sleep(time - vp::now_ps()); }

 private:
  void run() { script_(*this); }
  Script script_;
};

// Keeps when an interrupt line went up and down, and for whom.
class LineProbe : public sc_core::sc_module, public vp::InterruptIf {
 public:
  explicit LineProbe(const sc_core::sc_module_name& name) : sc_module(name) {}
  void interrupt(const vp::Tag& tag) override {
    up.push_back(vp::now_ps());
    tags.push_back(tag);
  }
  void lowered() override { down.push_back(vp::now_ps()); }

  std::vector<vp::Picoseconds> up, down;
  std::vector<vp::Tag> tags;
};

}  // namespace hvp::test
