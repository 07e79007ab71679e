// The frame loop does not allocate once the contact holds.
#include <atomic>
#include <cstdlib>
#include <new>

#include <gtest/gtest.h>

#include "tests/vp/small_scene.h"
#include "vp/platform.h"

namespace {
std::atomic<std::size_t> allocations = 0;
}  // namespace

void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace hvp::vp {
namespace {

// Counts what lies between the ends of two frames.
class Count : public FrameSink {
 public:
  void take(const Frame& frame, const std::vector<SpanId>& /*path*/) override {
    if (frame.number == 100) first = allocations;
    if (frame.number == 200) last = allocations;
  }
  std::size_t first = 0;
  std::size_t last = 0;
};

void expect_none(test::SmallScene& scene, int contact_changes) {
  scene.settings.servo.frames = 202;
  Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  Count count;
  platform.add_sink(count);
  platform.run();
  ASSERT_GT(count.first, 0U);
  EXPECT_EQ(count.last - count.first, 0U);
  EXPECT_EQ(platform.servo().counts().contact_changes, contact_changes);
}

TEST(Allocation, NoneWithoutContact) {
  test::SmallScene scene({.dynamics = fem::Dynamics{}, .solver = {}});
  expect_none(scene, 0);
}

TEST(Allocation, NoneInAHold) {
  test::SmallScene scene;
  scene.touch();
  expect_none(scene, 1);
}

}  // namespace
}  // namespace hvp::vp
