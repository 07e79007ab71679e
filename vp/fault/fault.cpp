#include "vp/fault/fault.h"

#include <string>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/time/picoseconds.h"

namespace hvp::vp {

namespace {

std::vector<std::pair<std::string_view, FaultKind>> kind_names() {
  std::vector<std::pair<std::string_view, FaultKind>> names;
  for (int i = 0; i < kFaultKinds; ++i) {
    const auto kind = static_cast<FaultKind>(i);
    names.emplace_back(name(kind), kind);
  }
  return names;
}

std::vector<std::pair<std::string_view, FaultAccess>> access_names() {
  std::vector<std::pair<std::string_view, FaultAccess>> names;
  for (int i = 0; i <= static_cast<int>(FaultAccess::solution); ++i) {
    const auto access = static_cast<FaultAccess>(i);
    names.emplace_back(name(access), access);
  }
  return names;
}

}  // namespace

const char* name(FaultKind kind) {
  switch (kind) {
    case FaultKind::lost_interrupt:
      return "lost-interrupt";
    case FaultKind::stuck_busy:
      return "stuck-busy";
    case FaultKind::saturated_solve:
      return "saturated-solve";
    case FaultKind::master_abort:
      return "master-abort";
    case FaultKind::device_gone:
      return "device-gone";
    case FaultKind::corrupted_word:
      return "corrupted-word";
    case FaultKind::late_dma:
      return "late-dma";
    case FaultKind::truncated_dma:
      return "truncated-dma";
  }
  return "";
}

const char* name(FaultAccess access) {
  switch (access) {
    case FaultAccess::first:
      return "first";
    case FaultAccess::rhs:
      return "rhs";
    case FaultAccess::start:
      return "start";
    case FaultAccess::status:
      return "status";
    case FaultAccess::acknowledge:
      return "acknowledge";
    case FaultAccess::solution:
      return "solution";
  }
  return "";
}

void Fault::declare(config::Visitor& v) {
  const auto of_kind = v.variant(
      "kind", kind, kind_names(),
      {.help = "what goes wrong; docs/faults.md says what comes of it", .required = true});
  v.integer("frame", frame, {-1, 100'000'000},
            {"the frame in which it happens; device-gone at 0: before the board is set up; -1: "
             "not at a frame, rate instead",
             "absent"});
  v.quantity("rate", rate, config::Dimension::dimensionless, config::between(0, 1),
             {"the probability that it happens in a frame, drawn for each; 0: not at a rate, frame "
              "instead",
              "absent"});
  of_kind.only({FaultKind::master_abort, FaultKind::corrupted_word}, [&] {
    v.choice("access", access, access_names(),
             {"which access of the frame to the board is hit; first: whichever comes first, for "
              "corrupted-word of the blocks",
              "any will do"});
  });
  of_kind.only({FaultKind::corrupted_word}, [&] {
    v.integer("bits", bits, {0, 32},
              {"how many bits of one word of 32 are flipped; 0: one",
               "the simplest: an odd number, which parity finds"});
  });
  of_kind.only({FaultKind::device_gone}, [&] {
    v.integer("frames", frames, {0, 100'000'000},
              {"after how many periods the board is back, reset; 0: never",
               "a board that was pulled out"});
  });
  of_kind.only({FaultKind::late_dma}, [&] {
    v.quantity("delay", delay_s, config::Dimension::time, {0, 10, true},
               {.help = "how long U waits before it leaves the board", .required = true});
  });
  of_kind.only({FaultKind::truncated_dma}, [&] {
    v.integer("bytes", bytes, {4, 1 << 20},
              {.help = "how many bytes of U's first segment stay on the board, from its end; a "
                       "multiple of 4",
               .required = true});
  });
}

void Fault::check() const {
  if (frame >= 0 && rate > 0) {
    throw InputError("rate", "expected either frame or rate, found both");
  }
  if (frame < 0 && !(rate > 0)) {
    throw InputError("frame", "expected the frame in which it happens, or a rate above 0");
  }
  const bool corrupted = kind == FaultKind::corrupted_word;
  if (kind == FaultKind::late_dma && !(delay_s > 0)) {
    throw InputError("delay", "late-dma needs it above 0 s");
  }
  if (kind == FaultKind::truncated_dma && (bytes <= 0 || bytes % 4 != 0)) {
    throw InputError("bytes",
                     fmt::format("truncated-dma needs it: expected a multiple of 4 above 0, "
                                 "found {}",
                                 bytes));
  }
  if (corrupted && access != FaultAccess::first && access != FaultAccess::rhs &&
      access != FaultAccess::solution) {
    throw InputError("access", fmt::format("only blocks are corrupted: expected \"first\", \"rhs\" "
                                           "or \"solution\", found \"{}\"",
                                           name(access)));
  }
}

std::int64_t Fault::delay_ps() const { return to_picoseconds(delay_s); }

}  // namespace hvp::vp
