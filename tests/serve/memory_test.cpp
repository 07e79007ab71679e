// Memory that goes while the board uses it: what the driver hears of it, and that the server
// stands.
#include <array>
#include <csignal>
#include <cstring>
#include <vector>

#include <sys/mman.h>

#include "driver/generated/hvp_registers.h"
#include "driver/hvp_driver.h"
#include "driver/user/vfio_user_client.h"
#include "models/fixed/reference_solver.h"
#include "tests/serve/served_program.h"
#include "tests/vp/board_master.h"
#include "tests/vp/small_scene.h"
#include "vp/host/driver_config.h"

namespace hvp::serve::memory_test {
namespace {

using test::RawClient;
using test::ServedProgram;
using test::SmallScene;

constexpr std::uint64_t kAddress = 0x1'0000'0000;  // beyond 32 bits
constexpr std::size_t kPage = 4096;
constexpr std::size_t kBytes = 4 * kPage;

// The driver over the socket, by DMA and messages, with a matrix loaded. What is to happen at the
// doorbell happens at once with it: no simulated time is in between.
class Driver {
 public:
  explicit Driver(const ServedProgram& served) {
    EXPECT_EQ(hvp_vfio_user_open(&way, served.socket().c_str()), 0);
    file = FileDescriptor(::memfd_create("hvp-test", MFD_CLOEXEC));
    EXPECT_EQ(::ftruncate(file.number(), kBytes), 0);
    memory = static_cast<std::uint32_t*>(
        ::mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_SHARED, file.number(), 0));
    EXPECT_EQ(hvp_vfio_user_map(&way, kAddress, kBytes, file.number(), 0), 0);
    plain = hvp_vfio_user_bus(&way);
    hvp_bus bus = plain;
    bus.context = this;
    bus.read32 = [](void* c, std::uint32_t at) noexcept {
      return self(c).plain.read32(self(c).plain.context, at);
    };
    bus.write32 = [](void* c, std::uint32_t at, std::uint32_t v) noexcept { self(c).write(at, v); };
    bus.read_block = [](void* c, std::uint32_t at, std::uint32_t* w, std::size_t n) noexcept {
      self(c).plain.read_block(self(c).plain.context, at, w, n);
    };
    bus.write_block = [](void* c, std::uint32_t at, const std::uint32_t* w,
                         std::size_t n) noexcept {
      self(c).plain.write_block(self(c).plain.context, at, w, n);
    };
    bus.wait_interrupt = [](void* c, std::uint64_t ns) noexcept {
      return self(c).plain.wait_interrupt(self(c).plain.context, ns);
    };
    bus.take_errors = nullptr;
    EXPECT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_OK);
    hvp_solver_config config = vp::driver_config(scene.settings.solver);
    config.start = HVP_START_FROM_ZERO;
    EXPECT_EQ(hvp_configure(&device, &config), HVP_OK);
    to_board = {memory, kAddress, kPage};
    // Last, so that its page can be cut off alone.
    to_host = {memory + 3 * kPage / 4, kAddress + 3 * kPage, kPage};
    hvp_dma dma{};
    dma.to_board = &to_board;
    dma.to_board_count = 1;
    dma.to_host = &to_host;
    dma.to_host_count = 1;
    dma.list = memory + kPage / 4;
    dma.list_address = kAddress + kPage;
    dma.record = memory + 2 * kPage / 4;
    dma.record_address = kAddress + 2 * kPage;
    EXPECT_EQ(hvp_use_dma(&device, &dma), HVP_OK);
    const fixed::QuantisedMatrix& k = scene.computation.board().matrix();
    const hvp_matrix matrix{static_cast<std::uint32_t>(k.block_rows()),
                            static_cast<std::uint32_t>(k.column.size()), k.row_begin.data(),
                            k.column.data(), k.value.data()};
    EXPECT_EQ(hvp_load_matrix(&device, &matrix), HVP_OK);
  }
  ~Driver() {
    ::munmap(memory, kBytes);
    hvp_vfio_user_close(&way);
  }

  hvp_status solve() { return hvp_solve(&device, b.data(), u.data(), u.size(), 60'000'000'000); }
  std::vector<std::int32_t> expected() const {
    std::vector<std::int32_t> solution(b.size(), 0);
    fixed::ReferenceSolver(scene.settings.solver)
        .solve(scene.computation.board().matrix(), {b, solution});
    return solution;
  }

  SmallScene scene;
  hvp_vfio_user way{};
  hvp_bus plain{};
  FileDescriptor file;
  std::uint32_t* memory = nullptr;
  hvp_segment to_board{};
  hvp_segment to_host{};
  hvp_device device{};
  std::vector<std::uint32_t> scratch = std::vector<std::uint32_t>(SmallScene::kUnknowns);
  std::vector<std::int32_t> b = test::words(SmallScene::kUnknowns, 200);
  std::vector<std::int32_t> u = std::vector<std::int32_t>(SmallScene::kUnknowns);
  enum class AtDoorbell { nothing, unmap, cut_off, die } at_doorbell = AtDoorbell::nothing;

 private:
  static Driver& self(void* context) { return *static_cast<Driver*>(context); }

  void write(std::uint32_t offset, std::uint32_t value) {
    if (offset != offsetof(hvp_t, CONTROL) || at_doorbell == AtDoorbell::nothing) {
      plain.write32(plain.context, offset, value);
      return;
    }
    if (at_doorbell == AtDoorbell::cut_off) {
      EXPECT_EQ(::ftruncate(file.number(), 3 * kPage), 0);
    }
    Bytes body;
    append(body, RegionAccess{offset, kBarRegion, 4});
    append(body, value);
    Bytes both = RawClient::message(Request::region_write, body, kNoReply);
    if (at_doorbell == AtDoorbell::unmap) {
      Bytes unmap;
      append(unmap, DmaUnmap{sizeof(DmaUnmap), 0, kAddress, kBytes});
      const Bytes second = RawClient::message(Request::dma_unmap, unmap, kNoReply);
      both.insert(both.end(), second.begin(), second.end());
    }
    EXPECT_EQ(::send(way.socket, both.data(), both.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(both.size()));
    if (at_doorbell == AtDoorbell::die) {
      ::shutdown(way.socket, SHUT_RDWR);
    }
    at_doorbell = AtDoorbell::nothing;
  }
};

std::vector<std::string> dma_and(const std::string& notification) {
  return {"--set", "transfer.method=dma", "--set", "transfer.notification=" + notification};
}

TEST(ServedMemory, TheDriverSolvesByDma) {
  for (const char* notification : {"msi", "intx"}) {
    ServedProgram served(dma_and(notification));
    Driver driver(served);
    EXPECT_EQ(driver.way.messages, notification == std::string("msi"));
    for (int i = 0; i < 3; ++i) {
      driver.u.assign(driver.u.size(), 0);
      ASSERT_EQ(driver.solve(), HVP_OK);
    }
    EXPECT_EQ(driver.u, driver.expected());
    EXPECT_EQ(hvp_statistics_of(&driver.device).lost_interrupts, 0U);
  }
}

TEST(ServedMemory, MemoryThatGoesInAJobIsADmaError) {
  for (const auto how : {Driver::AtDoorbell::unmap, Driver::AtDoorbell::cut_off}) {
    ServedProgram served(dma_and("msi"));
    {
      Driver driver(served);
      driver.at_doorbell = how;
      EXPECT_EQ(driver.solve(), HVP_ERROR_DMA);
      // It is the client's to put it right.
      if (how == Driver::AtDoorbell::cut_off) {
        EXPECT_EQ(hvp_vfio_user_unmap(&driver.way, kAddress, kBytes), 0);
        EXPECT_EQ(::ftruncate(driver.file.number(), kBytes), 0);
      }
      EXPECT_EQ(hvp_vfio_user_map(&driver.way, kAddress, kBytes, driver.file.number(), 0), 0);
    }
    served.expect_service();
    EXPECT_FALSE(served.maps("hvp-test"));
  }
}

TEST(ServedMemory, AClientThatDiesInAJobLeavesNothing) {
  ServedProgram served(dma_and("msi"));
  served.expect_service();
  RawClient(served.socket()).close();
  for (int i = 0; i < 3; ++i) {
    Driver driver(served);
    EXPECT_TRUE(served.maps("hvp-test"));
    driver.at_doorbell = Driver::AtDoorbell::die;
    EXPECT_EQ(hvp_write_rhs(&driver.device, driver.b.data(), driver.b.size()), HVP_OK);
    hvp_start(&driver.device);
  }
  Driver next(served);
  ASSERT_EQ(next.solve(), HVP_OK);
  EXPECT_EQ(next.u, next.expected());
}

// The line stays up, or the job's end is never taken: nothing more comes of it.
TEST(ServedMemory, AClientThatNeverAcknowledgesHarmsNobody) {
  for (const char* notification : {"msi", "intx"}) {
    ServedProgram served(dma_and(notification));
    {
      Driver driver(served);
      ASSERT_EQ(hvp_write_rhs(&driver.device, driver.b.data(), driver.b.size()), HVP_OK);
      ASSERT_EQ(hvp_start(&driver.device), HVP_OK);
      ASSERT_EQ(driver.plain.wait_interrupt(driver.plain.context, 60'000'000'000), HVP_INTERRUPT);
    }
    Driver next(served);
    ASSERT_EQ(next.solve(), HVP_OK);
    EXPECT_EQ(next.u, next.expected());
  }
}

}  // namespace
}  // namespace hvp::serve::memory_test
