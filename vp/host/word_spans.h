#pragma once

#include "vp/frame/ledger.h"

namespace hvp::vp {

// Keeps the ledger small where a block goes over the bus word by word: words that follow each other
// without a gap are one span, with one of arbitration before it for all their waiting. Words that
// were posted keep their spans, which others may follow.
class WordSpans {
 public:
  // The next words follow the tag; keeps references.
  WordSpans(Ledger& ledger, Tag& tag) : ledger_(ledger), tag_(tag), before_(tag.cause) {}

  // After each word.
  void fold();

 private:
  Ledger& ledger_;
  Tag& tag_;
  SpanId before_;  // what the first word that is folded follows
};

}  // namespace hvp::vp
