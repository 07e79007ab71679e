#include "app/run/force_watch.h"

namespace hvp::app {

void ForceWatch::solved(const vp::Frame& frame, const vp::Solution& solution) {
  for (std::size_t i = 0; i < qualities_.size(); ++i) {
    const collision::Touch& touch = frame.touches[i];
    stability::FeltForce felt{
        frame.number,       to_seconds(frame.time),        touch.tip, touch.force,
        touch.contact.node, !solution.hold.let_go.empty(), 0};
    if (touch.contact.present()) {
      felt.pull = touch.force.dot(contacts_.surface().rest_normal(touch.contact.node));
    }
    qualities_[i].add(felt);
  }
}

}  // namespace hvp::app
