#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "driver/hvp_status.h"
#include "models/collision/contact.h"
#include "models/fem/hold.h"
#include "models/plant/device.h"
#include "models/plant/output_stage.h"
#include "models/time/picoseconds.h"

namespace hvp::vp {

using hvp::Picoseconds;

// The parts of the system that take time in a frame, in the order of the results.
enum class Part : std::uint8_t { host, bus, fpga, daq, device, count };
inline constexpr auto kParts = static_cast<std::size_t>(Part::count);
inline constexpr std::array<std::string_view, kParts> kPartNames = {"host", "bus", "fpga", "daq",
                                                                    "device"};
static_assert(!kPartNames.back().empty(), "a part has no name");

enum class Phase : std::uint8_t {
  release,         // host: from n·T until the process begins
  wake_up,         // host: from being ready until the process runs
  blocked,         // host: ready, but the other process on the core cannot be preempted
  context_switch,  // host: from the other process on the core to this one
  sample,          // daq: latch and convert the position
  bus_read,        // bus: a single register
  bus_write,
  block_read,  // bus: a block
  block_write,
  arbitration,     // bus: waiting for another master, or for what was posted before
  posting,         // bus: the processor hands a posted write to the bridge and goes on
  dma_read,        // bus: the board reads the host's memory
  dma_write,       // bus: the board writes to it
  descriptor,      // bus: the board fetches descriptors
  message,         // bus: an interrupt as a write, or as a packet
  to_memory,       // bus: a board's posted write, from its last data phase until memory has it
  dma_engine,      // fpga: the board's DMA engine between its requests
  contact_lookup,  // host: fetch the contact node that the collision process published
  hold,            // host: the contact nodes' prescribed displacements, and their share of f̂
  node_update,     // fpga: clear or restore the rows of the contact node
  form_rhs,        // host: the modified force vector, in the board's words
  solve,           // fpga
  interrupt,       // host: from the board's request until the process runs again
  pipeline,        // host: another frame is worked on, or none until the next tick
  wait,            // host: blocked until the board is done, or looking whether it is
  polling,         // host: the board is done and the host has not looked yet
  driver,          // host: instructions of the driver around its bus accesses
  force,           // host: the contact force out of U
  convert,         // daq: the output's conversion and settling
  delay,           // host: the delay of a force by [host.delay]
  motor,           // device: the force is there
  update,          // host: Newmark's update, after the force is written
  refinement,      // host: the residual in double precision
  recovery,        // host: a board that failed is brought back, bus accesses included
  assemble,        // host: the matrix of the body as it is deformed, in the board's words
  load_values,     // host: the driver's work on them; fpga: the preconditioner for them
  bridge_status,   // host: a read of the errors that the bridge has recorded; not over the bus
  contact,         // host: where the proxies are, and their forces
  count
};
inline constexpr auto kPhases = static_cast<std::size_t>(Phase::count);
inline constexpr std::array<std::string_view, kPhases> kPhaseNames = {
    "release",       "wake-up",     "blocked",     "context switch", "sample",     "read",
    "write",         "block read",  "block write", "arbitration",    "posting",    "dma read",
    "dma write",     "descriptor",  "message",     "to memory",      "dma engine", "contact lookup",
    "hold",          "node update", "form rhs",    "solve",          "interrupt",  "pipeline",
    "wait",          "polling",     "driver",      "force",          "convert",    "delay",
    "motor",         "update",      "refinement",  "recovery",       "assemble",   "load values",
    "bridge status", "contact"};
static_assert(!kPhaseNames.back().empty(), "a phase has no name");

std::string_view name(Part part);
std::string_view name(Phase phase);

// The index of a span in its frame, or kBirth for the frame's birth.
using SpanId = int;
inline constexpr SpanId kBirth = -1;

// One piece of a frame's time, and the span that it had to wait for.
struct Span {
  Part part;
  Phase phase;
  Picoseconds start;
  Picoseconds end;
  SpanId cause;
};

// The state of a haptic device at a frame's latch, and the drive that the frame's force gave it.
struct DeviceRecord {
  plant::PlantState plant;
  bool read_wrong = false;  // the position that was read is more than an encoder step from the tip
  Eigen::Vector3d read_current =
      Eigen::Vector3d::Zero();  // motor currents in A, if an ADC reads them
  plant::Drive drive;
};

// What the host had between its rendering and a haptic device, with the effects
// [host.virtual_coupling] and [host.passivity].
struct PortRecord {
  Eigen::Vector3d read = Eigen::Vector3d::Zero();     // the position that was read, m
  Eigen::Vector3d damping = Eigen::Vector3d::Zero();  // N, added to the force on the body
  double observed_J = 0;                              // the controller's count
};

// One tick of the servo loop, from its birth at n·T to the force at the motor and the end of the
// work that belongs to its period. The servo process writes what the frame saw and did, step by
// step; the ledger alone writes spans.
struct Frame {
  std::int64_t number = 0;
  Picoseconds born = 0;
  Picoseconds time = 0;  // its birth, since the servo loop began
  // The process was at work beyond the tick: so long that it was not woken for the frame, or until
  // before the timer's release.
  bool beyond_tick = false;
  bool not_woken = false;

  // One entry for each probe: the position read for its tip, or that of its virtual tool, its
  // contact, and the force on the body.
  std::vector<collision::Touch> touches;
  // One entry for each probe; empty without the effects of the port.
  std::vector<PortRecord> ports;
  // One entry for each device with mass; empty if no device has mass.
  std::vector<DeviceRecord> devices;
  Picoseconds latched = 0;  // when the positions were latched
  Picoseconds contact_age =
      0;  // at the lookup, from the begin of the pass that found the contact; 0: no contact
  hvp_status status = HVP_OK;    // else the reason why the frame has a held force
  std::int64_t saturations = 0;  // clamped words in its solve
  std::int64_t flips = 0;        // bits of the board that flip behind the start of its solve
  std::uint32_t flags = 0;       // stability::Flags of its solve

  std::vector<Span> spans;
  SpanId force_at_motor = kBirth;  // the span at whose end the force is at the motor
  Picoseconds work_done = 0;       // when all work of the period is done, the update included

  bool solved() const { return status == HVP_OK; }
  bool in_contact() const;
  // The position that the host read of a probe, m, and what it sends to the device, as the force on
  // the body, N.
  const Eigen::Vector3d& read(std::size_t probe) const {
    return ports.empty() ? touches[probe].tip : ports[probe].read;
  }
  Eigen::Vector3d sent(std::size_t probe) const {
    if (ports.empty()) return touches[probe].force;
    return touches[probe].force + ports[probe].damping;
  }
  // The first probe's.
  const collision::Touch& touch() const { return touches.front(); }
  Picoseconds latency() const { return spans[static_cast<std::size_t>(force_at_motor)].end - born; }
};

// Throws std::logic_error, because the record of a frame contradicts itself, which no input can
// bring about.
[[noreturn]] void broken(const Frame& frame, const std::string& what);

// The solution of a frame. It is valid only during the call that gets it.
struct Solution {
  fem::Hold hold;                        // displacements that contact prescribes
  std::span<const double> displacement;  // of the active nodes, m
};

// The frame that a transaction or an interrupt works for, and the span that it follows.
struct Tag {
  std::int64_t frame = -1;  // −1: set-up, no frame
  SpanId cause = kBirth;
};

// The begin of the servo loop. Set-up, which loads K, comes before it. The probes' trajectories and
// all results count time from here.
struct Session {
  Picoseconds begin = 0;
  bool begun = false;
};

}  // namespace hvp::vp
