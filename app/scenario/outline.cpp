#include "app/scenario/outline.h"

#include <utility>

#include "app/scenario/message.h"

namespace hvp::scenario {

using config::Note;

Describer::Describer() : outline_(1), stack_(1) {}

void Describer::key(std::string_view name, const Key& key, const Note& note) {
  table().rows.push_back({std::string(name), key, std::string(note.help), std::string(note.source),
                          note.required, stack_.back().conditions, keys_++});
}

void Describer::open(OutlineTable::Kind kind, std::string_view name, const Note& note) {
  OutlineTable opened{
      joined(table().path, name), kind,          stack_.back().index,     std::string(note.help),
      std::string(note.source),   note.required, stack_.back().conditions};
  stack_.push_back({outline_.size()});
  outline_.push_back(std::move(opened));
}

void Describer::note_effect(OutlineTable& table, const config::EffectNote& note) {
  table.is_effect = true;
  table.cost = note.cost;
  table.needs = note.needs;
  table.implied = note.implied;
}

bool Describer::begin_condition(const config::Condition& condition) {
  stack_.back().conditions.push_back(condition);
  return true;
}

void Describer::begin_table(std::string_view name, Note note) {
  open(OutlineTable::Kind::table, name, note);
}

bool Describer::begin_effect(std::string_view name, bool& /*present*/,
                             const config::EffectNote& note) {
  open(OutlineTable::Kind::effect, name, {.help = note.help});
  note_effect(table(), note);
  return true;
}

// Its keys stand under the table whose place it takes.
bool Describer::begin_optional(std::string_view name, bool& /*present*/, Note note) {
  open(OutlineTable::Kind::optional, name, note);
  stack_.pop_back();
  return false;
}

bool Describer::begin_list(std::string_view name, std::size_t& /*count*/, Note note) {
  open(OutlineTable::Kind::list, name, note);
  return false;
}

void Describer::list_is_effect(std::string_view name, bool /*present*/,
                               const config::EffectNote& note) {
  const std::string path = joined(table().path, name);
  for (OutlineTable& listed : outline_) {
    if (listed.path == path) note_effect(listed, note);
  }
}

}  // namespace hvp::scenario
