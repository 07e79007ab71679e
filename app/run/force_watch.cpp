#include "app/run/force_watch.h"

namespace hvp::app {

void ForceWatch::solved(const vp::SolvedFrame& frame) {
  stability::FeltForce felt{frame.number,
                            1e-12 * static_cast<double>(frame.time),
                            frame.tip,
                            frame.force,
                            frame.contact.node,
                            !frame.hold.let_go.empty(),
                            0};
  if (frame.contact.node >= 0) {
    felt.pull = frame.force.dot(contacts_.surface().rest_normal(frame.contact.node));
  }
  quality_.add(felt);
}

}  // namespace hvp::app
