#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "driver/hvp_driver.h"
#include "models/collision/contact.h"
#include "models/fem/hold.h"
#include "models/plant/device.h"
#include "models/plant/output_stage.h"
#include "models/time/picoseconds.h"

namespace hvp::vp {

using hvp::Picoseconds;

// What takes time in a frame, in the order that results have.
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
  hold,            // host: where the contact's nodes are held, and what that does to f̂
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
  delay,           // host: what a force is held back by [host.delay]
  motor,           // device: the force is there
  update,          // host: Newmark's update, after the force is written
  refinement,      // host: the residual in double precision
  recovery,        // host: a board that failed is brought back, bus accesses included
  bridge_status,   // host: what the bridge has recorded of errors; not over the bus
  count
};
inline constexpr auto kPhases = static_cast<std::size_t>(Phase::count);
inline constexpr std::array<std::string_view, kPhases> kPhaseNames = {
    "release",   "wake-up",     "blocked",     "context switch", "sample",       "read",
    "write",     "block read",  "block write", "arbitration",    "posting",      "dma read",
    "dma write", "descriptor",  "message",     "to memory",      "dma engine",   "contact lookup",
    "hold",      "node update", "form rhs",    "solve",          "interrupt",    "pipeline",
    "wait",      "polling",     "driver",      "force",          "convert",      "delay",
    "motor",     "update",      "refinement",  "recovery",       "bridge status"};
static_assert(!kPhaseNames.back().empty(), "a phase has no name");

std::string_view name(Part part);
std::string_view name(Phase phase);

// An index into a frame's spans, or the frame's birth.
using SpanId = int;
inline constexpr SpanId kBirth = -1;

// What took time in a frame, and which span it had to wait for.
struct Span {
  Part part;
  Phase phase;
  Picoseconds start;
  Picoseconds end;
  SpanId cause;
};

// A device in a frame: at its latch, and with the force that the frame made.
struct DeviceRecord {
  plant::PlantState plant;
  bool read_wrong = false;  // the position read is not the tip's, by more than a step
  Eigen::Vector3d read_current = Eigen::Vector3d::Zero();  // A, where an ADC reads them
  plant::Drive drive;
};

// One tick of the servo loop, from its birth at n·T to the force at the motor and the end of the
// work that belongs to its period. The servo process writes what the frame saw and did, step by
// step; what took time is the ledger's to write.
struct Frame {
  std::int64_t number = 0;
  Picoseconds born = 0;
  Picoseconds time = 0;  // its birth, since the servo loop began

  // A probe each: where its tip was read to be, what it holds, and the force on the body.
  std::vector<collision::Touch> touches;
  // Of each device that has mass: what it did, and what it was told. Empty where none has.
  std::vector<DeviceRecord> devices;
  Picoseconds latched = 0;       // when the positions were
  Picoseconds contact_age = 0;   // at the lookup, since the pass that found it began; 0: none
  hvp_status status = HVP_OK;    // else: why the force of an earlier frame is held
  std::int64_t saturations = 0;  // in its solve
  std::uint32_t flags = 0;       // stability::Flags of its solve

  std::vector<Span> spans;
  SpanId force_at_motor = kBirth;  // the span with which the force is there
  Picoseconds work_done = 0;       // all work of the period is done, the update included

  bool solved() const { return status == HVP_OK; }
  bool in_contact() const;
  // Of the first probe.
  const collision::Touch& touch() const { return touches.front(); }
  Picoseconds latency() const { return spans[static_cast<std::size_t>(force_at_motor)].end - born; }
};

// Throws std::logic_error: the record of a frame contradicts itself, which no input can bring
// about.
[[noreturn]] void broken(const Frame& frame, const std::string& what);

// What a frame was solved to; valid while it is looked at.
struct Solution {
  fem::Hold hold;                        // what contact prescribed
  std::span<const double> displacement;  // active nodes, m
};

// Which part and frame a transaction or an interrupt works for, and what it follows.
struct Tag {
  std::int64_t frame = -1;  // −1: set-up, no frame
  SpanId cause = kBirth;
};

}  // namespace hvp::vp
