#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "app/record/comparison.h"
#include "models/config/figures.h"

// What `hvp replay` prints.
namespace hvp::record {

// The register at an offset of the BAR.
using RegisterName = std::function<std::string(std::uint64_t offset)>;

// One side of a difference.
struct SideFigures {
  std::string what;                 // "read STATUS", "message", "none"
  std::optional<std::string> word;  // the first that differs, as 0x00000003
  Picoseconds asked = 0;
  Picoseconds ended = 0;
  bool present = false;

  void report(config::Figures& f) const;
};

struct DifferenceFigures {
  std::string what;  // "access", "interrupt" or "transfer"
  std::int64_t number = 0;
  std::string place;  // of the first word that differs
  SideFigures recorded;
  SideFigures replayed;

  void report(config::Figures& f) const;
};

struct TallyFigures {
  std::string name;
  Tally tally;

  void report(config::Figures& f) const;
};

struct ReplayFigures {
  std::string recorded_from;  // the host that was recorded
  Picoseconds simulated = 0;  // by the record
  std::string cut;
  std::vector<TallyFigures> tallies;
  std::optional<DifferenceFigures> first;
  std::optional<DifferenceFigures> first_of_time;

  void report(config::Figures& f) const;
};

// `there` is the replay of `here`, or the record of another driver.
ReplayFigures figures_of(const Record& here, const Comparison& comparison,
                         const RegisterName& name);

// The text for the terminal. `other` is what the second record is called: "replayed".
std::string text_of(const ReplayFigures& figures, std::string_view other);

}  // namespace hvp::record
