#include "app/record/replay_figures.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "app/results/number_text.h"

namespace hvp::record {

namespace {

constexpr std::size_t kWordBytes = 4;

std::string_view name_of(What what) {
  switch (what) {
    case What::access:
      return "access";
    case What::interrupt:
      return "interrupt";
    case What::transfer:
      return "transfer";
  }
  return "";
}

std::string place_in(const Entry& entry, std::uint64_t offset, const RegisterName& name) {
  const std::uint64_t at = entry.address + offset;
  if (entry.kind != Kind::asked) return fmt::format("{:#x}", at);
  if (entry.has(kTable)) return fmt::format("table of MSI-X {:#x}", at);
  return entry.has(kConfiguration) ? fmt::format("configuration space {:#x}", at) : name(at);
}

std::string size_text(const Entry& entry) {
  if (entry.bytes == kWordBytes) return {};
  if (entry.bytes % kWordBytes != 0 || entry.bytes == 0) {
    return fmt::format("{} bytes of ", entry.bytes);
  }
  return fmt::format("{} words from ", entry.bytes / kWordBytes);
}

std::string what_is(const Item& item, const RegisterName& name) {
  const Entry& entry = *item.entry;
  switch (entry.kind) {
    case Kind::asked:
      return fmt::format("{} {}{}{}", entry.has(kWrite) ? "write" : "read", size_text(entry),
                         place_in(entry, 0, name), item.end == nullptr ? ", without an end" : "");
    case Kind::message:
      return fmt::format("message {:#x} to {:#x}", number_in(entry), entry.address);
    case Kind::line:
      return entry.has(kUp) ? "INTA# up" : "INTA# down";
    case Kind::memory_read:
    case Kind::memory_write:
      return fmt::format("the board {} {} bytes at {:#x}{}",
                         entry.kind == Kind::memory_read ? "reads" : "writes", entry.bytes,
                         entry.address, entry.has(kAnswered) ? "" : ", refused");
    case Kind::ended:
    case Kind::map:
    case Kind::unmap:
    case Kind::missing:
    case Kind::end:
    case Kind::fault:
      break;
  }
  return "none";
}

// The word at a place in the data: fewer bytes at its end, none behind it.
std::optional<std::string> word_at(const Item& item, std::size_t at) {
  const auto data = data_of(item);
  if (at >= data.size()) return std::nullopt;
  const auto bytes = data.subspan(at, std::min(kWordBytes, data.size() - at));
  std::uint32_t word = 0;
  for (std::size_t i = bytes.size(); i > 0; --i) word = word << 8U | bytes[i - 1];
  return fmt::format("0x{:0{}x}", word, 2 * bytes.size());
}

SideFigures side(const std::optional<Item>& item, std::size_t word, const RegisterName& name) {
  SideFigures figures;
  figures.present = item && item->entry->kind != Kind::missing;
  figures.what = figures.present ? what_is(*item, name) : "none";
  if (!figures.present) return figures;
  figures.asked = item->entry->time;
  figures.ended = item->time();
  const Kind kind = item->entry->kind;
  if (kind != Kind::message && kind != Kind::line) figures.word = word_at(*item, word);
  return figures;
}

std::optional<DifferenceFigures> figures_of(const std::optional<Difference>& difference,
                                            const RegisterName& name) {
  if (!difference) return std::nullopt;
  const std::optional<Item>& here = difference->here;
  const std::optional<Item>& there = difference->there;
  const std::size_t word = here && there ? first_differing_word(*here, *there).value_or(0) : 0;
  DifferenceFigures figures;
  figures.what = name_of(difference->what);
  figures.number = difference->number;
  figures.recorded = side(here, word, name);
  figures.replayed = side(there, word, name);
  const Entry& entry = here ? *here->entry : *there->entry;
  if (difference->what != What::interrupt) figures.place = place_in(entry, word, name);
  return figures;
}

std::string side_text(const SideFigures& side) {
  if (!side.present) return side.what;
  std::string text = side.what;
  if (side.word) text += ": " + *side.word;
  const std::string begin = results::microseconds(side.asked);
  if (side.ended == side.asked) return text + fmt::format(", at {} us", begin);
  return text + fmt::format(", from {} to {} us", begin, results::microseconds(side.ended));
}

std::string difference_text(std::string_view title, const DifferenceFigures& figures,
                            std::string_view other) {
  const std::string place = figures.place.empty() ? "" : ", " + figures.place;
  return fmt::format("\n{}: {} {}{}\n  {:<9} {}\n  {:<9} {}\n", title, figures.what, figures.number,
                     place, "recorded", side_text(figures.recorded), other,
                     side_text(figures.replayed));
}

}  // namespace

void SideFigures::report(config::Figures& f) const {
  f.text("what", what, "the access, the interrupt or the board's transfer; `none`: there is none");
  f.value("word", word ? config::FigureValue(*word) : config::FigureValue(), {},
          "the first word that differs, or the first one; null where there is none");
  f.value("begin_us",
          present ? config::FigureValue(static_cast<double>(asked) / 1e6) : config::FigureValue(),
          config::kMicroseconds, "simulated time at which it was asked for, or happened");
  f.value("end_us",
          present ? config::FigureValue(static_cast<double>(ended) / 1e6) : config::FigureValue(),
          config::kMicroseconds, "simulated time of its end");
}

void DifferenceFigures::report(config::Figures& f) const {
  f.text("what", what, "`access`, `interrupt` or `transfer`");
  f.count("number", number, "of its kind, from 0");
  f.text("place", place, "the register or the address of the word; empty for an interrupt");
  f.table("recorded", "in the record", recorded);
  f.table("replayed", "in the replay, or in the record of `--against`", replayed);
}

void TallyFigures::report(config::Figures& f) const {
  f.count("recorded", tally.here, "how many the record has");
  f.count("replayed", tally.there, "how many the replay has, or the record of `--against`");
  f.count("compared", tally.compared(), "how many both have");
  f.count("differ", tally.differ, "how many differ, those included that only one has");
  f.count("other_times", tally.other_times, "how many are alike but at other times");
  f.time("largest_time_us", tally.largest, "the largest difference of these times");
}

void ReplayFigures::report(config::Figures& f) const {
  f.text("host", recorded_from, "the host that was recorded");
  f.time("simulated_us", simulated, "simulated time of the record");
  f.text("cut", cut, "why the record has no end; empty for a whole one");
  f.tables("compared", "of each kind", tallies,
           [](const TallyFigures& t) { return std::string_view(t.name); });
  f.table_or_null("first", "the first difference; null: there is none", first);
  f.table_or_null("first_of_time", "the first of what is alike but at another time", first_of_time);
}

ReplayFigures figures_of(const Record& here, const Comparison& comparison,
                         const RegisterName& name) {
  ReplayFigures figures;
  figures.recorded_from = record::name(here.layer());
  figures.simulated = here.last();
  figures.cut = here.cut();
  figures.first = figures_of(comparison.first, name);
  figures.first_of_time = figures_of(comparison.first_of_time, name);
  constexpr std::array<std::string_view, kWhats> kPlurals = {"accesses", "interrupts", "transfers"};
  for (std::size_t w = 0; w < kWhats; ++w) {
    figures.tallies.push_back({std::string(kPlurals.at(w)), comparison.tallies.at(w)});
  }
  return figures;
}

std::string text_of(const ReplayFigures& figures, std::string_view other) {
  std::string text = fmt::format("Recorded: {}, {} us\n", figures.recorded_from,
                                 results::microseconds(figures.simulated));
  for (const TallyFigures& figure : figures.tallies) {
    const Tally& t = figure.tally;
    text += fmt::format("  {:<12}{} of {} compared, {} differ", figure.name, t.compared(),
                        std::max(t.here, t.there), t.differ);
    if (t.other_times > 0) {
      text += fmt::format("; {} at other times, by at most {}", t.other_times,
                          results::readable_time(t.largest));
    }
    text += '\n';
  }
  if (figures.first) text += difference_text("First difference", *figures.first, other);
  if (figures.first_of_time) {
    text += difference_text("First at another time", *figures.first_of_time, other);
  }
  return text;
}

}  // namespace hvp::record
