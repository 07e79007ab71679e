#include "vp/host/transfer.h"

namespace hvp::vp {

void Transfer::declare(config::Visitor& v) {
  using config::Dimension;
  const auto of_method = v.variant(
      "method", method,
      {{"bursts", Method::bursts},
       {"programmed-io", Method::programmed_io},
       {"write-combined-io", Method::write_combined_io},
       {"dma", Method::dma}},
      {"bursts: the processor moves blocks, in the bridge's bursts both ways, on PCI only; "
       "programmed-io: a store or a load a word; write-combined-io: stores in bursts, a load a "
       "word; dma: the board moves b, U and the values of a renewed matrix, all else goes in "
       "bursts",
       "the link of thesis section 6.2.1 at its best: processors read uncached words one by one "
       "(docs/transfers.md)"});
  const auto of_notification = v.variant(
      "notification", notification,
      {{"intx", link::Notification::intx},
       {"msi", link::Notification::msi},
       {"polling", link::Notification::polling}},
      {"how the host hears of a job's end: a line, with a read of STATUS; a message, which is a "
       "write behind the board's data; or by looking, at STATUS or, with dma, at memory",
       "what every PCI board has"});
  of_notification.only({link::Notification::polling}, [&] {
    v.quantity("poll_interval", poll_interval_s, Dimension::time, config::between(10e-9, 10e-3),
               {"between two looks", "about a read over the bus"});
  });
  v.boolean("packed", packed,
            {"elements of at most 16 bits travel two in a word of 32; false: one a word",
             "thesis section 6.2.1: the link is what limits"});
  of_method.only({Method::dma}, [&] {
    v.effect("dma", dma,
             {"the board's DMA engine",
              "a process of the board that is master of the bus; simulated time of its requests",
              {},
              true});
  });
}

MasterSettings Transfer::master() const {
  MasterSettings master;
  if (method == Method::dma) master.dma = engine();
  master.messages = notification == link::Notification::msi;
  return master;
}

std::size_t Transfer::rhs_bytes(const fixed::Settings& solver, std::size_t unknowns) const {
  const link::Payload words{0, 0, solver.residual_bits(), packed};
  return static_cast<std::size_t>(words.bytes(static_cast<std::int64_t>(unknowns)));
}

std::size_t Transfer::solution_bytes(const fixed::Settings& solver, std::size_t unknowns) const {
  const link::Payload words{0, 0, solver.vector_bits, packed};
  return static_cast<std::size_t>(words.bytes(static_cast<std::int64_t>(unknowns)));
}

std::size_t Transfer::values_bytes(const fixed::Settings& solver, std::size_t entries) const {
  const link::Payload words{0, 0, solver.matrix_bits, packed};
  return static_cast<std::size_t>(words.bytes(static_cast<std::int64_t>(entries)));
}

bool Transfer::plain() const {
  return method == Method::bursts && notification == link::Notification::intx && packed;
}

const char* name(Transfer::Method method) {
  switch (method) {
    case Transfer::Method::bursts:
      return "bursts";
    case Transfer::Method::programmed_io:
      return "programmed-io";
    case Transfer::Method::write_combined_io:
      return "write-combined-io";
    case Transfer::Method::dma:
      return "dma";
  }
  return "";
}

const char* key_of(link::Notification notification) {
  switch (notification) {
    case link::Notification::polling:
      return "polling";
    case link::Notification::intx:
      return "intx";
    case link::Notification::msi:
      return "msi";
  }
  return "";
}

}  // namespace hvp::vp
