#include "app/results/bus_load.h"

namespace hvp::results {

namespace {

void report_shares(config::Figures& f, const BusLoad& load) {
  f.ratio("share", load.share, "the share of the time in which it was taken");
  f.ratio("worst_frame_share", load.worst_share,
          "from one frame's solution to the next one's, where that was most");
}

void report_initiators(config::Figures& f, const BusLoad& load, std::string_view help) {
  vp::BusUses had;
  for (const vp::BusUse& use : load.uses) {
    if (use.transactions > 0 || use.busy > 0) had.push_back(use);
  }
  f.list("by_initiator", help, had, [&](const vp::BusUse& use) {
    f.text("initiator", use.name, "`processor`, `board`, `traffic` or `graphics`");
    f.ratio("share", load.share_of(use), "of the time");
    f.time("busy_us", use.busy, "how long");
    f.count("bytes", use.bytes, "that it moved");
    f.count("transactions", use.transactions, "in how many");
  });
}

}  // namespace

void BusFigures::report(config::Figures& f) const {
  f.count("transactions", transactions, "the processor's");
  f.count("bytes", bytes, "that those moved");
  f.time("busy_us", busy, "the time that anybody's took");
  f.table("utilisation",
          "of the servo loop's time, set-up not included. Loosely timed, a transaction takes the "
          "bus for all its time; approximately timed, for as long as it owns it",
          [&] {
            report_shares(f, load);
            report_initiators(f, load, "who had it; who never had is left out");
          });
  f.if_present(link, [&](const Link& l) {
    f.table("pcie",
            "with `[bus.pcie]` only, of the solver board's link: the rest of `bus` is then the PCI "
            "bus, where the DAQ stays. All times are of the packets on the wire",
            [&] {
              f.table("utilisation",
                      "of the link's two directions: a read has its requests in one and its "
                      "completions in the other. Loosely timed, a packet carries its share of the "
                      "link layer's; approximately timed those count as they are sent",
                      [&] {
                        f.table("to_board", {}, [&] { report_shares(f, l.to_board); });
                        f.table("to_host", {}, [&] { report_shares(f, l.to_host); });
                        report_initiators(f, l.to_board,
                                          "the time of the direction in which the data go");
                      });
            });
  });
}

}  // namespace hvp::results
