#include "models/accel/several.h"

#include "models/config/input_error.h"

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

}  // namespace hvp::accel
