#include "vp/fidelity.h"

#include <initializer_list>
#include <string_view>
#include <utility>
#include <vector>

namespace hvp::vp {

namespace {

template <class Level>
std::vector<std::pair<std::string_view, Level>> named(std::initializer_list<Level> levels) {
  std::vector<std::pair<std::string_view, Level>> options;
  for (const Level level : levels) options.emplace_back(name(level), level);
  return options;
}

}  // namespace

void Fidelity::declare(config::Visitor& v, const config::Condition& body) {
  v.when(body, [&] {
    v.choice("accelerator", accelerator,
             named({Timing::untimed, Timing::loosely_timed, Timing::approximately_timed,
                    Timing::cycle_accurate, Timing::rtl}),
             {"loosely-timed: a closed form of clocks; approximately-timed: an event a phase, its "
              "stalls from conflicts; cycle-accurate: every clock of the engine; rtl: the same "
              "beside the engine in SystemVerilog, words and clocks compared; untimed: no time",
              "the level that answers whether a budget holds"});
  });
  v.choice("bus", bus, named({Timing::untimed, Timing::loosely_timed, Timing::approximately_timed}),
           {"loosely-timed: latency and bursts; approximately-timed: arbitration, clock edges and "
            "other masters; untimed: no time",
            "the level that answers whether a budget holds"});
  v.choice("host", host, named({Timing::untimed, Timing::loosely_timed}),
           {"loosely-timed: annotated costs; untimed: no time",
            "the level that answers whether a budget holds"});
  v.when(body, [&] {
    v.choice("numbers", numbers, named({Numbers::fixed, Numbers::none}),
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
    case Timing::rtl:
      return "rtl";
  }
  return "";
}

bool has_engine(Timing level) {
  return level == Timing::approximately_timed || engine_has_words(level);
}

bool engine_has_words(Timing level) {
  return level == Timing::cycle_accurate || level == Timing::rtl;
}

const char* name(Numbers level) { return level == Numbers::none ? "none" : "fixed"; }

}  // namespace hvp::vp
