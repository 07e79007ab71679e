#include "app/run/force_watch.h"

namespace hvp::app {

void ForceWatch::solved(const vp::Frame& frame, const vp::Solution& solution) {
  stability::FeltForce felt{frame.number,
                            to_seconds(frame.time),
                            frame.touch().tip,
                            frame.touch().force,
                            frame.touch().contact.node,
                            !solution.hold.let_go.empty(),
                            0};
  if (frame.touch().contact.present()) {
    felt.pull =
        frame.touch().force.dot(contacts_.surface().rest_normal(frame.touch().contact.node));
  }
  quality_.add(felt);
}

}  // namespace hvp::app
