#include "vp/fidelity.h"

namespace hvp::vp {

void Fidelity::declare(config::Visitor& v) {
  const auto timing = [&v](std::string_view part, Timing& level, std::string_view help) {
    v.choice(part, level, {{"untimed", Timing::untimed}, {"loosely-timed", Timing::loosely_timed}},
             {help, "the level that answers whether a budget holds"});
  };
  timing("accelerator", accelerator, "loosely-timed: a closed form of clocks; untimed: no time");
  timing("bus", bus, "loosely-timed: latency and bursts; untimed: no time");
  timing("host", host, "loosely-timed: annotated costs; untimed: no time");
  v.choice("numbers", numbers, {{"fixed", Numbers::fixed}},
           {"fixed: bit-true fixed point", "thesis section 4.2"});
}

const char* name(Timing level) { return level == Timing::untimed ? "untimed" : "loosely-timed"; }

const char* name(Numbers /*level*/) { return "fixed"; }

}  // namespace hvp::vp
