#include "vp/fault/fault_plan.h"

#include <algorithm>
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
  for (int i = 0; i <= static_cast<int>(FaultAccess::values); ++i) {
    const auto access = static_cast<FaultAccess>(i);
    names.emplace_back(name(access), access);
  }
  return names;
}

std::vector<std::pair<std::string_view, engine::FlipPlace>> place_names() {
  std::vector<std::pair<std::string_view, engine::FlipPlace>> names;
  for (std::size_t i = 0; i < engine::kFlipPlaces; ++i) {
    const auto place = static_cast<engine::FlipPlace>(i);
    names.emplace_back(engine::name(place), place);
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
    case FaultKind::surprise_removal:
      return "surprise-removal";
    case FaultKind::function_level_reset:
      return "function-level-reset";
    case FaultKind::aer_correctable:
      return "aer-correctable";
    case FaultKind::aer_uncorrectable:
      return "aer-uncorrectable";
    case FaultKind::flip:
      return "flip";
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
    case FaultAccess::values:
      return "values";
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
  v.integer("count", count, {1, 100'000'000},
            {"in how many frames in a row it happens, from `frame` on", "a single one"});
  v.quantity("rate", rate, config::Dimension::dimensionless, config::between(0, 1),
             {"the probability that it happens in a frame, drawn for each; 0: not at a rate, frame "
              "instead",
              "absent"});
  of_kind.only(
      {FaultKind::master_abort, FaultKind::corrupted_word, FaultKind::surprise_removal,
       FaultKind::aer_correctable, FaultKind::aer_uncorrectable},
      [&] {
        v.choice(
            "access", access, access_names(),
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
              {"after how many of budget.period since that frame's birth the board is back, reset; "
               "0: never",
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
  of_kind.only({FaultKind::flip}, [&] { declare_flip(v); });
}

void Fault::declare_flip(config::Visitor& v) {
  using engine::FlipPlace;
  const auto of_place = v.variant(
      "place", flip.place, place_names(),
      {.help = "what the bit is of: a memory of the vectors, where previous is x before the last "
               "job; with a preconditioner z, and the diagonal of its inverse; the matrix; nodes, "
               "owner, phase and last, parts of an index word; the registers of a coefficient, "
               "r·r, the iterations and the exponents of r and d",
       .required = true});
  v.integer("clock", clock, {-1, 1'000'000'000},
            {"behind which clock from the start of the frame's job on; behind its end, too; -1: "
             "drawn over those of a solve",
             "any will do"});
  v.integer("bit", flip.bit, {-1, 63}, {"which, from the lowest one on; -1: drawn", "any will do"});
  const auto index = [&v](const char* key, int& value, int most, const char* help) {
    v.integer(key, value, {-1, most}, {help, "any will do"});
  };
  of_place.only({FlipPlace::x, FlipPlace::r, FlipPlace::z, FlipPlace::b, FlipPlace::q,
                 FlipPlace::previous, FlipPlace::inverse, FlipPlace::d},
                [&] {
                  index("node", flip.node, 1 << 20, "of which node; -1: drawn");
                  index("component", flip.component, 2, "0 x, 1 y, 2 z; -1: drawn");
                });
  of_place.only({FlipPlace::d, FlipPlace::matrix, FlipPlace::nodes, FlipPlace::owner,
                 FlipPlace::phase, FlipPlace::last},
                [&] {
                  index("partition", flip.partition, 1 << 10,
                        "of which partition; of d: of its copy; -1: drawn");
                });
  of_place.only({FlipPlace::d}, [&] {
    index("copy", flip.copy, 1, "of which of the partition's copies, if it has two; -1: drawn");
  });
  of_place.only(
      {FlipPlace::matrix, FlipPlace::nodes, FlipPlace::owner, FlipPlace::phase, FlipPlace::last},
      [&] {
        index("package", flip.package, 1 << 24,
              "of which package, as the partition reads them; -1: drawn");
      });
  of_place.only({FlipPlace::matrix},
                [&] { index("row", flip.row, 2, "of which of the package's rows; -1: drawn"); });
  of_place.only({FlipPlace::matrix, FlipPlace::nodes}, [&] {
    index("column", flip.column, 1 << 10,
          "of which of the package's columns, of nodes: of which of its nodes; -1: drawn");
  });
}

void Fault::check() const {
  if (frame >= 0 && rate > 0) {
    throw InputError("rate", "expected either frame or rate, found both");
  }
  if (comes_next()) {
    throw InputError("frame", "expected the frame in which it happens, or a rate above 0");
  }
  check_injected();
}

void Fault::check_injected() const {
  if (frame >= 0 && rate > 0) {
    throw InputError("rate", "expected either frame or rate, found both");
  }
  if (rate > 0 && count > 1) {
    throw InputError("count", "goes with frame: a rate is drawn for each frame");
  }
  if (kind == FaultKind::device_gone && frames == 0 && count > 1) {
    throw InputError("count", "a board that is gone for good goes once: expected frames above 0");
  }
  if (kind == FaultKind::surprise_removal && count > 1) {
    throw InputError("count", "a board that is pulled out goes once: expected 1");
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
  if (kind == FaultKind::aer_uncorrectable &&
      (access == FaultAccess::status || access == FaultAccess::solution)) {
    throw InputError("access", fmt::format("only a write is poisoned: expected \"first\", \"rhs\", "
                                           "\"start\", \"acknowledge\" or \"values\", found \"{}\"",
                                           name(access)));
  }
  if (corrupted && access != FaultAccess::first && access != FaultAccess::rhs &&
      access != FaultAccess::solution && access != FaultAccess::values) {
    throw InputError("access", fmt::format("only blocks are corrupted: expected \"first\", "
                                           "\"rhs\", \"solution\" or \"values\", found \"{}\"",
                                           name(access)));
  }
}

namespace {

// What a frame of the fault's number did not do.
std::string_view missing_in_frame(const Fault& fault) {
  switch (fault.kind) {
    case FaultKind::lost_interrupt:
      return "the board raised no interrupt";
    case FaultKind::stuck_busy:
    case FaultKind::saturated_solve:
    case FaultKind::function_level_reset:
    case FaultKind::flip:
      return "no solve was started";
    case FaultKind::master_abort:
    case FaultKind::corrupted_word:
    case FaultKind::surprise_removal:
    case FaultKind::aer_correctable:
    case FaultKind::aer_uncorrectable:
      return "no such access was made";
    case FaultKind::late_dma:
    case FaultKind::truncated_dma:
      return "the board's engine moved no U";
    case FaultKind::device_gone:
      return "the board was not asked for anything";
  }
  return "";
}

}  // namespace

std::int64_t FaultRecord::missing() const {
  if (fault.rate > 0) return injected > 0 ? 0 : 1;
  return fault.count - injected;
}

std::string FaultRecord::why_not(std::int64_t frames) const {
  if (injected > 0) return {};
  if (!effect.lacking.empty()) return "the engine has no such bit: " + effect.lacking;
  if (fault.comes_next()) {
    return fmt::format(
        "it was asked for after {} frame{}, and since then {} that no other fault took",
        asked_after, asked_after == 1 ? "" : "s", missing_in_frame(fault));
  }
  if (fault.frame < 0) {
    return fmt::format("at a rate of {} none was drawn in {} frames", fault.rate, frames);
  }
  if (fault.frame >= frames) {
    return fmt::format("it is asked for in frame {}, and there were {}", fault.frame, frames);
  }
  if (fault.count > 1) {
    return fmt::format("in frames {} to {} {}", fault.frame, fault.frame + fault.count - 1,
                       missing_in_frame(fault));
  }
  return fmt::format("in frame {} {}", fault.frame, missing_in_frame(fault));
}

std::int64_t Fault::delay_ps() const { return to_picoseconds(delay_s); }

namespace {

// A draw's later attempts stand for other questions about the same fault.
constexpr std::uint32_t kWhichWord = 1;
constexpr std::uint32_t kWhichBit = 2;
constexpr std::uint32_t kWhichIndex = 64;

random::Draws draws_of(int kind, std::int64_t seed) {
  return {seed, std::string("fault.") + name(static_cast<FaultKind>(kind))};
}

template <std::size_t... kind>
std::array<random::Draws, kFaultKinds> all_draws(std::int64_t seed,
                                                 std::index_sequence<kind...> /*kinds*/) {
  return {draws_of(static_cast<int>(kind), seed)...};
}

std::uint32_t one_of(double uniform, std::uint32_t count) {
  return std::min(static_cast<std::uint32_t>(uniform * count), count - 1);
}

}  // namespace

FaultPlan::FaultPlan(const std::vector<Fault>& faults, std::int64_t seed, Picoseconds period)
    : period_(period), draws_(all_draws(seed, std::make_index_sequence<kFaultKinds>())) {
  for (const Fault& fault : faults) add(fault);
}

void FaultPlan::add(const Fault& fault, std::int64_t frames) {
  const auto of_kind = std::ranges::count_if(
      records_, [&fault](const FaultRecord& r) { return r.fault.kind == fault.kind; });
  FaultRecord& record = records_.emplace_back();
  record.fault = fault;
  record.asked_after = frames;
  items_.push_back({static_cast<std::uint32_t>(of_kind), -1, {-1, -1}});
}

bool FaultPlan::due(std::size_t item, std::int64_t frame) const {
  const Fault& fault = records_[item].fault;
  if (frame < 0) return false;
  if (fault.frame >= 0) return frame >= fault.frame && frame - fault.frame < fault.count;
  if (fault.comes_next()) return records_[item].injected < fault.count;
  return draws_[static_cast<std::size_t>(fault.kind)].uniform(frame, items_[item].number).first <
         fault.rate;
}

namespace {

bool takes_the_board_away(FaultKind kind) {
  return kind == FaultKind::device_gone || kind == FaultKind::surprise_removal;
}

}  // namespace

void FaultPlan::inject(std::size_t item, std::int64_t frame) {
  FaultRecord& record = records_[item];
  ++record.injected;
  if (record.first_frame < 0) record.first_frame = frame;
  Item& i = items_[item];
  i.struck = frame;
  i.open[1] = i.open[0];
  i.open[0] = frame;
  if (takes_the_board_away(record.fault.kind) && i.absent_since < 0) i.absent_since = frame;
}

const Fault* FaultPlan::strike(FaultKind kind, std::int64_t frame, FaultAccess access) {
  for (std::size_t item = 0; item < items_.size(); ++item) {
    const Fault& fault = records_[item].fault;
    if (fault.kind != kind || items_[item].struck == frame) continue;
    if (fault.access != FaultAccess::first && fault.access != access) continue;
    if (!due(item, frame)) continue;
    inject(item, frame);
    return &fault;
  }
  return nullptr;
}

std::uint32_t FaultPlan::word(const Fault& fault, std::int64_t frame, std::uint32_t words) const {
  const random::Draws& draws = draws_[static_cast<std::size_t>(fault.kind)];
  return one_of(draws.uniform(frame, items_[item_of(fault)].number, kWhichWord).first, words);
}

// A mask of this number of different bits: the first ones of a shuffled word.
std::uint32_t FaultPlan::mask(const Fault& fault, std::int64_t frame) const {
  const random::Draws& draws = draws_[static_cast<std::size_t>(fault.kind)];
  std::array<std::uint32_t, 32> order{};
  for (std::uint32_t i = 0; i < 32; ++i) order[i] = i;
  std::uint32_t mask = 0;
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(fault.flipped_bits()); ++i) {
    const double u = draws.uniform(frame, items_[item_of(fault)].number, kWhichBit + i).first;
    std::swap(order[i], order[i + one_of(u, 32 - i)]);
    mask |= 1U << order[i];
  }
  return mask;
}

std::int64_t FaultPlan::choose(const Fault& fault, std::int64_t frame, std::uint32_t number,
                               std::int64_t range) const {
  const random::Draws& draws = draws_[static_cast<std::size_t>(fault.kind)];
  const double u = draws.uniform(frame, items_[item_of(fault)].number, kWhichIndex + number).first;
  return one_of(u, static_cast<std::uint32_t>(range));
}

void FaultPlan::retract(const Fault& fault) {
  const std::size_t item = item_of(fault);
  FaultRecord& record = records_[item];
  if (--record.injected == 0) record.first_frame = -1;
  items_[item].open[0] = items_[item].open[1];
  items_[item].open[1] = -1;
}

// By address, because the faults that are handed out are those of the records.
std::size_t FaultPlan::item_of(const Fault& fault) const {
  const auto hit = std::find_if(records_.begin(), records_.end(),
                                [&fault](const FaultRecord& r) { return &r.fault == &fault; });
  return static_cast<std::size_t>(hit - records_.begin());
}

std::optional<std::int64_t> FaultPlan::leaves(std::size_t item, Picoseconds now,
                                              std::int64_t frame) const {
  const Fault& fault = records_[item].fault;
  if (fault.kind != FaultKind::device_gone) return std::nullopt;
  const std::int64_t struck = items_[item].struck;
  if (fault.frame < 0) {
    // Where it comes next it is there for whoever asks, in set-up too.
    const std::int64_t asks = fault.comes_next() ? std::max<std::int64_t>(newest_.frame, 0) : frame;
    return struck != asks && due(item, asks) ? std::optional(asks) : std::nullopt;
  }
  const std::int64_t next = struck < 0 ? fault.frame : struck + 1;
  if (next - fault.frame >= fault.count) return std::nullopt;
  const bool has_come =
      next == 0 || newest_.frame >= next || (begin_ >= 0 && now >= begin_ + next * period_);
  return has_come ? std::optional(next) : std::nullopt;
}

// 0 for a board that is gone before the first frame.
Picoseconds FaultPlan::birth_of(std::int64_t frame) const {
  return begin_ >= 0 ? begin_ + frame * period_ : newest_.time;
}

void FaultPlan::leave(std::size_t item, std::int64_t frame) {
  const Fault& fault = records_[item].fault;
  inject(item, frame);
  const Picoseconds back = fault.frames == 0 ? kNever : birth_of(frame) + fault.frames * period_;
  back_at_ = gone_ ? std::max(back_at_, back) : back;
  gone_ = true;
}

bool FaultPlan::gone(Picoseconds now, std::int64_t frame) {
  for (std::size_t item = 0; item < items_.size(); ++item) {
    while (const auto from = leaves(item, now, frame)) leave(item, *from);
  }
  if (gone_ && now >= back_at_) {
    gone_ = false;
    returned_ = true;
  }
  return gone_;
}

void FaultPlan::remove() {
  gone_ = true;
  removed_ = true;
  back_at_ = kNever;
}

void FaultPlan::notice_item(std::size_t item, std::int64_t frame) {
  for (std::int64_t& open : items_[item].open) {
    if (open != frame) continue;
    open = -1;
    ++records_[item].noticed;
  }
}

void FaultPlan::notice_failure(std::int64_t frame) {
  for (std::size_t item = 0; item < items_.size(); ++item) {
    Item& i = items_[item];
    if (!takes_the_board_away(records_[item].fault.kind)) {
      notice_item(item, frame);
    } else if (i.absent_since >= 0 && i.absent_since <= frame) {
      // Whoever asks for a board that is gone finds out, whenever he asks, and however many frames
      // it was to be gone in until then.
      records_[item].noticed = records_[item].injected;
      i.open = {-1, -1};
      i.absent_since = -1;
    }
  }
}

void FaultPlan::notice(FaultKind kind, std::int64_t frame) {
  for (std::size_t item = 0; item < items_.size(); ++item) {
    if (records_[item].fault.kind == kind) notice_item(item, frame);
  }
}

void FaultPlan::correct(const Fault& fault) {
  const std::size_t item = item_of(fault);
  items_[item].open[0] = -1;
  ++records_[item].corrected;
}

std::int64_t FaultPlan::injected() const {
  std::int64_t count = 0;
  for (const FaultRecord& record : records_) count += record.injected;
  return count;
}

std::int64_t FaultPlan::unnoticed() const {
  std::int64_t count = 0;
  for (const FaultRecord& record : records_) count += record.unnoticed();
  return count;
}

}  // namespace hvp::vp
