#include "models/accel/architecture.h"

#include <bit>

#include "models/config/effects.h"
#include "models/config/input_error.h"
#include "models/time/picoseconds.h"

namespace hvp::accel {

void Several::declare(config::Visitor& v) {
  using config::Dimension;
  v.integer("devices", devices, {2, 8},
            {"FPGAs that share the rows of K, all of the kind that accelerator.device names",
             "2: the two EP2S60 of thesis section 6.2"});
  v.choice("vectors", vectors, {{"split", VectorWork::split}, {"unsplit", VectorWork::unsplit}},
           {"split: each device works on the vector entries of its own rows; unsplit: every device "
            "on all of them, and A*d is exchanged instead of d",
            "the faster one; the thesis announces a double-FPGA design and does not describe it"});
  v.choice("exchange", exchange, {{"all", Exchange::all}, {"halo", Exchange::halo}},
           {"whether a device gets all of d or what its rows touch, with rows partitioned by METIS",
            "thesis section 5.6: d is replicated whole"});
  v.choice("topology", topology,
           {{"ring", Topology::ring}, {"fully-connected", Topology::fully_connected}},
           {"how the devices are linked; two devices have one link either way",
            "the authors' later design is a ring of four (Mahdavikhah et al., FPGA 2010)"});
  v.quantity("link_latency", link_latency_s, Dimension::time, config::between(0, 1e-3),
             {"from a word's register in one device to its register in the next",
              "assumed: eight clocks of 100 MHz for output, board, input and synchronisation"});
  v.integer("link_width", link_width, {1, 4096},
            {"bits a link moves each way in a clock of its own",
             "assumed; the thesis' appendix A shows links between the FPGAs without figures"});
  v.quantity("link_clock", link_clock_hz, Dimension::frequency, config::between(1e6, 1e11),
             {"clock of the links, or the bit rate of a lane",
              "assumed: the engine's own, source-synchronous"});
}

void Several::check() const {
  if (vectors == VectorWork::unsplit && exchange == Exchange::halo) {
    throw InputError("exchange",
                     "\"halo\" contradicts vectors = \"unsplit\": every device then needs all of "
                     "A*d; expected exchange = \"all\", or vectors = \"split\"");
  }
}

void Architecture::declare(config::Visitor& v) {
  using config::Dimension;
  v.text("device", device,
         {"the FPGA: one of docs/devices.md, or a file of your own that ends in .toml, relative to "
          "the scenario",
          "thesis section 6.1"});
  v.quantity("clock", clock_hz, Dimension::frequency, config::between(1e6, 1e9),
             {.help = "clock of the whole engine; fastest: the highest that this architecture "
                      "reaches in this device (docs/critical-path.md)",
              .source = "thesis section 5.5 and Table 6.2",
              .word = "fastest"});
  v.integer("rows_in_parallel", rows_in_parallel, {1, 3},
            {"PL1: rows of one node worked on together", "thesis section 5.3"});
  v.integer("package", package, {1, 64},
            {"PL2: non-zero columns a clock and row", "thesis sections 5.3 and 5.4"});
  v.integer("partitions", partitions, {1, 256},
            {"PL3: partitions of the matrix worked on together", "thesis section 5.3"});
  v.integer("packages_per_row", packages_per_row, {0, 1024},
            {"s: packages that every row has, padded; 0: as many as it needs",
             "thesis section 5.3 leaves s to the mesh"});
  v.integer("nodes_per_clock", nodes_per_clock, {1, 64},
            {"L: nodes the vector unit takes in a clock, a power of two",
             "2, from 21 multipliers in section 6.1; the thesis does not say"});
  v.integer("pipeline_clocks", pipeline_clocks, {0, 1000},
            {"clocks from the first operand of a phase to its last result: the three depths below "
             "and the vector unit, which has the rest",
             "assumed"});
  v.integer("memory_read_clocks", memory_read_clocks, {1, 100},
            {"depth of a memory's read: address and output register",
             "Stratix II device handbook: both registers for full speed"});
  v.integer("multiplier_clocks", multiplier_clocks, {1, 100},
            {"depth of a multiplier: input, pipeline and output register",
             "Stratix II device handbook: a DSP block's three ranks"});
  v.integer("adder_tree_clocks", adder_tree_clocks, {1, 100},
            {"depth of an adder tree with its accumulator",
             "three ranks for eight products, and the accumulator"});
  v.boolean("absolute_value_register", absolute_value_register,
            {"a register between absolute value and multiplier, which are the critical path of "
             "thesis Fig. 5.10: one clock more in every pipeline",
             "thesis section 5.5"});
  v.integer(
      "division_clocks", division_clocks, {0, 1000},
      {"clocks of one division and the re-scaling behind it; 0: as many as they take, 68 with "
       "the thesis' words",
       "a step a clock: docs/accelerator.md; the thesis does not say"});
  v.integer("result_queue", result_queue, {1, 1024},
            {"rows that a partition finishes ahead of the vector unit, a power of two",
             "assumed: an M512's words"});
  v.choice("direction_memory", direction_memory,
           {{"double-pumped", DirectionMemory::double_pumped},
            {"two-copies", DirectionMemory::two_copies},
            {"stall", DirectionMemory::stall}},
           {"how four reads of d a clock are had from memories with two ports; stall: they are "
            "not, and a third read of a bank takes another clock",
            "two copies do not fit the EP2S60; the thesis does not say"});
  v.integer("direction_banks", direction_banks, {1, 64},
            {"memories that the nodes of a component of d are dealt to in turn, a power of two",
             "thesis Fig. 5.9: one a component"});
  constexpr std::string_view kWidest =
      "thesis section 5.4: M4K, of which a Stratix II reads most bits a clock";
  v.text("matrix_memory", matrix_memory,
         {"the device's memory type that holds the matrix; auto: docs/accelerator.md", kWidest});
  v.text("index_memory", index_memory,
         {"the same for the indices of the packages", "thesis section 5.4: M-RAM, the largest"});
  v.text("copies_memory", copies_memory, {"the same for the copies of d", kWidest});
  v.text("vector_memory", vector_memory, {"the same for the other vectors", kWidest});
  v.text("preconditioner_memory", preconditioner_memory,
         {"the same for z and the inverse diagonal or blocks of a preconditioner", kWidest});
  v.text("queue_memory", queue_memory,
         {"the same for the rows that wait for the vector unit",
          "the smallest type: a few words; the thesis does not say"});
  v.choice("matrix_storage", matrix_storage,
           {{"full", MatrixStorage::full}, {"symmetric", MatrixStorage::symmetric}},
           {"whether both blocks (i, j) and (j, i) are stored, or one for both",
            "full: thesis section 5.1 knows the symmetry and section 5.4 stores all non-zeros"});
  v.boolean(
      "parity_bits", parity_bits,
      {"parity bits of the memories hold data too", "thesis section 5.4, footnote: not used"});
  v.text("multiplier_mode", multiplier_mode,
         {"the way to use the device's multipliers, docs/devices.md; auto: the first one",
          "independent multipliers"});
  v.effect("several", several,
           {"several devices share the rows of K; without it there is one",
            "simulated time of the links; the words are those of one device",
            {config::need_board(),
             {"fidelity.accelerator",
              {"loosely-timed", "untimed"},
              "the finer levels have no model of several devices"},
             {"transfer.method",
              {"bursts", "programmed-io", "write-combined-io"},
              "DMA reaches one device's memories"}}});
}

void Architecture::check() const {
  // A node's memory and place are bits of its number, and a queue's place wraps like a counter.
  const auto power_of_two = [](const char* key, int value) {
    const auto bits = static_cast<unsigned>(value);
    if (std::has_single_bit(bits)) return;
    throw InputError(key, "found " + std::to_string(value) + ", expected a power of two, as " +
                              std::to_string(std::bit_floor(bits)) + " or " +
                              std::to_string(std::bit_ceil(bits)) +
                              ": hardware has no division for addresses");
  };
  power_of_two("nodes_per_clock", nodes_per_clock);
  power_of_two("direction_banks", direction_banks);
  power_of_two("result_queue", result_queue);
  if (vector_clocks() < 1) {
    throw InputError("pipeline_clocks",
                     "expected more than memory_read_clocks, multiplier_clocks and "
                     "adder_tree_clocks together, which leave the vector unit nothing of " +
                         std::to_string(pipeline_clocks));
  }
  if (several && matrix_storage == MatrixStorage::symmetric) {
    throw InputError("matrix_storage",
                     "\"symmetric\" has no model of several devices: expected full with "
                     "[accelerator.several]");
  }
}

std::int64_t Architecture::clock_period_ps() const { return to_period(clock_hz); }

}  // namespace hvp::accel
