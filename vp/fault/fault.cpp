#include "vp/fault/fault.h"

#include <cmath>
#include <string>

#include <fmt/format.h>

#include "models/config/input_error.h"

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
  v.choice("kind", kind, kind_names(),
           {.help = "what goes wrong; docs/faults.md says what comes of it", .required = true});
  v.integer("frame", frame, {-1, 100'000'000},
            {"the frame in which it happens; device-gone at 0: before the board is set up; -1: "
             "not at a frame, rate instead",
             "absent"});
  v.quantity("rate", rate, config::Dimension::dimensionless, config::between(0, 1),
             {"the probability that it happens in a frame, drawn for each; 0: not at a rate, frame "
              "instead",
              "absent"});
  v.choice("access", access, access_names(),
           {"master-abort, corrupted-word: which access of the frame to the board is hit; first: "
            "whichever comes first, for corrupted-word of the blocks",
            "any will do"});
  v.integer("bits", bits, {0, 32},
            {"corrupted-word: how many bits of one word of 32 are flipped; 0: one",
             "the simplest: an odd number, which parity finds"});
  v.integer("frames", frames, {0, 100'000'000},
            {"device-gone: after how many periods the board is back, reset; 0: never",
             "a board that was pulled out"});
  v.quantity("delay", delay_s, config::Dimension::time, config::between(0, 10),
             {"late-dma: how long U waits before it leaves the board", "absent"});
  v.integer("bytes", bytes, {0, 1 << 20},
            {"truncated-dma: how many bytes of U's first segment stay on the board, from its end",
             "absent"});
}

void Fault::check() const {
  if (frame >= 0 && rate > 0) {
    throw InputError("rate", "expected either frame or rate, found both");
  }
  if (frame < 0 && !(rate > 0)) {
    throw InputError("frame", "expected the frame in which it happens, or a rate above 0");
  }
  const auto belongs = [this](const char* key, bool given, bool mine, const char* kinds) {
    if (!given || mine) return;
    throw InputError(key,
                     fmt::format("belongs to kind = {} only, found \"{}\"", kinds, name(kind)));
  };
  const bool corrupted = kind == FaultKind::corrupted_word;
  belongs("access", access != FaultAccess::first, corrupted || kind == FaultKind::master_abort,
          "\"master-abort\" or \"corrupted-word\"");
  belongs("bits", bits != 0, corrupted, "\"corrupted-word\"");
  belongs("frames", frames != 0, kind == FaultKind::device_gone, "\"device-gone\"");
  belongs("delay", delay_s != 0, kind == FaultKind::late_dma, "\"late-dma\"");
  belongs("bytes", bytes != 0, kind == FaultKind::truncated_dma, "\"truncated-dma\"");
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

std::int64_t Fault::delay_ps() const { return std::llround(delay_s * 1e12); }

}  // namespace hvp::vp
