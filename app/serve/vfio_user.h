#pragma once

#include <cstddef>
#include <cstdint>

#include "driver/hvp_pci.h"

// vfio-user is the protocol by which a virtual machine monitor uses a PCI device that another
// process models. This header defines its numbers and its structures as they go over the socket, in
// the machine's own byte order. Source: QEMU, docs/interop/vfio-user.rst, version 0.9.2; the
// indices and flags are those of <linux/vfio.h>.
namespace hvp::serve {

inline constexpr std::uint16_t kMajor = 0;
inline constexpr std::uint16_t kMinor = 1;

enum class Request : std::uint16_t {
  version = 1,
  dma_map = 2,
  dma_unmap = 3,
  device_get_info = 4,
  device_get_region_info = 5,
  device_get_irq_info = 7,
  device_set_irqs = 8,
  region_read = 9,
  region_write = 10,
  device_reset = 13,
  region_write_multi = 15,
};

// The header of every message.
struct Header {
  std::uint16_t id = 0;  // the reply has the id of its command
  std::uint16_t command = 0;
  std::uint32_t size = 0;  // of the whole message with its header
  std::uint32_t flags = 0;
  std::uint32_t error = 0;  // an errno, in a reply with kErrorFlag
};
inline constexpr std::uint32_t kTypeMask = 0xf;
inline constexpr std::uint32_t kReplyType = 1;
inline constexpr std::uint32_t kNoReply = 1U << 4U;
inline constexpr std::uint32_t kErrorFlag = 1U << 5U;

struct Version {
  std::uint16_t major = 0;
  std::uint16_t minor = 0;
};

struct DmaMap {
  std::uint32_t argsz = 0;
  std::uint32_t flags = 0;
  std::uint64_t offset = 0;  // in the file that comes with the message
  std::uint64_t address = 0;
  std::uint64_t size = 0;
};
inline constexpr std::uint32_t kReadable = 1;
inline constexpr std::uint32_t kWritable = 2;

struct DmaUnmap {
  std::uint32_t argsz = 0;
  std::uint32_t flags = 0;
  std::uint64_t address = 0;
  std::uint64_t size = 0;
};
inline constexpr std::uint32_t kUnmapAll = 2;

struct DeviceInfo {
  std::uint32_t argsz = 0;
  std::uint32_t flags = 0;
  std::uint32_t regions = 0;
  std::uint32_t interrupts = 0;
};
inline constexpr std::uint32_t kDeviceResets = 1;
inline constexpr std::uint32_t kDevicePci = 2;

struct RegionInfo {
  std::uint32_t argsz = 0;
  std::uint32_t flags = 0;
  std::uint32_t index = 0;
  std::uint32_t capabilities = 0;
  std::uint64_t size = 0;
  std::uint64_t offset = 0;
};
inline constexpr std::uint32_t kRegionReadable = 1;
inline constexpr std::uint32_t kRegionWritable = 2;
inline constexpr std::uint32_t kBarRegion = HVP_PCI_BAR;
inline constexpr std::uint32_t kTableRegion = 2;  // BAR 2
inline constexpr std::uint32_t kConfigRegion = 7;
inline constexpr std::uint32_t kRegions = 9;

struct InterruptInfo {
  std::uint32_t argsz = 0;
  std::uint32_t flags = 0;
  std::uint32_t index = 0;
  std::uint32_t count = 0;
};
inline constexpr std::uint32_t kByEventfd = 1;
inline constexpr std::uint32_t kMaskable = 2;
inline constexpr std::uint32_t kAutoMasked = 4;
inline constexpr std::uint32_t kNoResize = 8;
inline constexpr std::uint32_t kLineIndex = 0;
inline constexpr std::uint32_t kMessageIndex = 1;
inline constexpr std::uint32_t kTableMessageIndex = 2;  // MSI-X
inline constexpr std::uint32_t kErrorIndex = 3;         // an uncorrectable error of PCI Express
inline constexpr std::uint32_t kInterruptIndices = 5;

struct SetInterrupts {
  std::uint32_t argsz = 0;
  std::uint32_t flags = 0;
  std::uint32_t index = 0;
  std::uint32_t start = 0;
  std::uint32_t count = 0;
};
inline constexpr std::uint32_t kDataNone = 1;
inline constexpr std::uint32_t kDataBool = 2;
inline constexpr std::uint32_t kDataEventfd = 4;
inline constexpr std::uint32_t kActionMask = 8;
inline constexpr std::uint32_t kActionUnmask = 16;
inline constexpr std::uint32_t kActionTrigger = 32;

// The head of region_read, region_write and their replies; the data follows.
struct RegionAccess {
  std::uint64_t offset = 0;
  std::uint32_t region = 0;
  std::uint32_t count = 0;
};
// The most bytes of one write in region_write_multi. The writes follow their number (64 bits).
inline constexpr std::size_t kSmallWrite = 8;

static_assert(sizeof(Header) == 16 && sizeof(Version) == 4 && sizeof(DmaMap) == 32 &&
              sizeof(DmaUnmap) == 24 && sizeof(DeviceInfo) == 16 && sizeof(RegionInfo) == 32 &&
              sizeof(InterruptInfo) == 16 && sizeof(SetInterrupts) == 20 &&
              sizeof(RegionAccess) == 16);

// The limits of this server, which its reply to version states.
inline constexpr std::size_t kLargestTransfer = 1U << 20U;
inline constexpr std::size_t kMostFiles = 8;
// Each map keeps a file open.
inline constexpr std::size_t kMostMaps = 256;
inline constexpr std::size_t kLargestMessage =
    sizeof(Header) + sizeof(RegionAccess) + kLargestTransfer;

}  // namespace hvp::serve
