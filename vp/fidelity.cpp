#include "vp/fidelity.h"

namespace hvp::vp {

void Fidelity::declare(config::Visitor& v, const config::Condition& body) {
  const auto timing = [&v](std::string_view part, Timing& level, std::string_view help) {
    v.choice(part, level, {{"untimed", Timing::untimed}, {"loosely-timed", Timing::loosely_timed}},
             {help, "the level that answers whether a budget holds"});
  };
  v.when(body, [&] {
    v.choice("accelerator", accelerator,
             {{"untimed", Timing::untimed},
              {"loosely-timed", Timing::loosely_timed},
              {"approximately-timed", Timing::approximately_timed},
              {"cycle-accurate", Timing::cycle_accurate}},
             {"loosely-timed: a closed form of clocks; approximately-timed: an event a phase, its "
              "stalls from conflicts; cycle-accurate: every clock of the engine; untimed: no time",
              "the level that answers whether a budget holds"});
  });
  v.choice("bus", bus,
           {{"untimed", Timing::untimed},
            {"loosely-timed", Timing::loosely_timed},
            {"approximately-timed", Timing::approximately_timed}},
           {"loosely-timed: latency and bursts; approximately-timed: arbitration, clock edges and "
            "other masters; untimed: no time",
            "the level that answers whether a budget holds"});
  timing("host", host, "loosely-timed: annotated costs; untimed: no time");
  v.when(body, [&] {
    v.choice("numbers", numbers, {{"fixed", Numbers::fixed}, {"none", Numbers::none}},
             {"fixed: bit-true fixed point; none: timing only, the same accesses and costs while "
              "nobody computes words, forces or deformations",
              "thesis section 4.2"});
  });
}

const char* name(Timing level) {
  switch (level) {
    case Timing::untimed:
      return "untimed";
    case Timing::loosely_timed:
      return "loosely-timed";
    case Timing::approximately_timed:
      return "approximately-timed";
    case Timing::cycle_accurate:
      return "cycle-accurate";
  }
  return "";
}

bool has_engine(Timing level) {
  return level == Timing::approximately_timed || level == Timing::cycle_accurate;
}

const char* name(Numbers level) { return level == Numbers::none ? "none" : "fixed"; }

}  // namespace hvp::vp
