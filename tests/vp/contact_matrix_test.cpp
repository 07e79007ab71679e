// The matrix on the board while the contact moves (thesis section 6.2.1): K but for the rows and
// columns of the nodes that follow the probe now.
#include <cstring>
#include <set>

#include <gtest/gtest.h>

#include "tests/vp/small_scene.h"
#include "vp/fpga/register_bank.h"
#include "vp/platform.h"

namespace hvp::vp::contact_matrix_test {
namespace {

using test::SmallScene;

std::vector<std::int32_t> cleared(const fixed::QuantisedMatrix& k, std::span<const int> contact,
                                  std::int32_t diagonal) {
  const auto touched = [&](int node) {
    return std::find(contact.begin(), contact.end(), node) != contact.end();
  };
  std::vector<std::int32_t> value = k.value;
  for (int row = 0; row < k.block_rows(); ++row) {
    for (int i = k.row_begin[static_cast<std::size_t>(row)];
         i < k.row_begin[static_cast<std::size_t>(row) + 1]; ++i) {
      const auto block = static_cast<std::size_t>(i);
      const int column = k.column[block];
      if (!touched(row) && !touched(column)) continue;
      for (std::size_t e = 0; e < 9; ++e) {
        value[9 * block + e] = row == column && e % 4 == 0 ? diagonal : 0;
      }
    }
  }
  return value;
}

// Compares VALUE with K after every frame.
class MatrixWatch : public FrameObserver {
 public:
  MatrixWatch(const SmallScene& scene, const Platform& platform)
      : scene_(scene), platform_(platform) {}

  void solved(const Frame& frame, const Solution& solution) override {
    const fixed::QuantisedMatrix& k = scene_.computation.board().matrix();
    const std::vector<std::int32_t> expected =
        cleared(k, solution.hold.nodes, scene_.computation.board().diagonal_word());
    const auto words = platform_.accelerator().bank().memory(Aperture::value);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_EQ(packed_element(words, i, 12), expected[i])
          << "frame " << frame.number << ", element " << i;
    }
    contacts.insert(std::vector<int>(solution.hold.nodes.begin(), solution.hold.nodes.end()));
  }
  std::set<std::vector<int>> contacts;

 private:
  const SmallScene& scene_;
  const Platform& platform_;
};

// The driver's contract: a row that is given back has zeros towards nodes that are constrained.
class ContractWatch : public AccessObserver {
 public:
  explicit ContractWatch(const fixed::QuantisedMatrix& k) : k_(k) {}

  void access(Picoseconds /*time*/, Command command, const RegisterBank& bank,
              const AccessResult& /*outcome*/, std::uint64_t offset,
              std::span<const std::uint8_t> data) override {
    const std::uint64_t control = kRegisters[static_cast<std::size_t>(Register::control)].offset;
    if (command != Command::write || offset != control) return;
    std::uint32_t word = 0;
    std::memcpy(&word, data.data(), 4);
    if (word != field::kControlUpdateNode.mask()) return;
    const int node = static_cast<int>(bank.get(field::kUpdateNodeNode));
    if (bank.get(field::kUpdateKindKind) == static_cast<std::uint32_t>(UpdateKind::constrain)) {
      EXPECT_TRUE(constrained_.insert(node).second) << node;
      return;
    }
    EXPECT_EQ(constrained_.erase(node), 1U) << node;
    ++restored;
    const auto first = static_cast<std::size_t>(k_.row_begin[static_cast<std::size_t>(node)]);
    for (std::size_t block = 0; block < k_.row(node).size() / 9; ++block) {
      if (!constrained_.contains(k_.column[first + block])) continue;
      for (std::size_t e = 0; e < 9; ++e) {
        EXPECT_EQ(packed_element(bank.memory(Aperture::row), 9 * block + e, 12), 0);
      }
    }
  }
  int restored = 0;

 private:
  const fixed::QuantisedMatrix& k_;
  std::set<int> constrained_;
};

void slide_and_compare(double patch_radius, std::size_t patch_nodes) {
  SmallScene scene({.dynamics = {}, .solver = {}, .patch_radius = patch_radius});
  scene.slide(0.15);
  scene.settings.frames = 120;
  ContractWatch contract(scene.computation.board().matrix());
  Platform platform(scene.settings, scene.body, scene.computation, scene.contacts, &contract);
  MatrixWatch watch(scene, platform);
  platform.add_observer(watch);
  platform.run();
  EXPECT_GE(watch.contacts.size(), 3U);  // none, the first node, the second
  EXPECT_GE(contract.restored, 1);
  for (const std::vector<int>& contact : watch.contacts) {
    EXPECT_TRUE(contact.empty() || contact.size() >= patch_nodes) << contact.size();
  }
  EXPECT_EQ(platform.accelerator().illegal_accesses(), 0);
  EXPECT_EQ(platform.servo().counts().driver_errors, 0);
}

TEST(ContactMatrix, SingleNode) { slide_and_compare(0, 1); }
// The node and its four neighbours along the edges, of which the old and the new patch share two.
TEST(ContactMatrix, Patch) { slide_and_compare(0.021, 5); }

}  // namespace
}  // namespace hvp::vp::contact_matrix_test
