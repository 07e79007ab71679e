#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <systemc>
#include <vector>

#include <tlm_utils/simple_target_socket.h>

#include "models/plant/device.h"
#include "models/plant/device_settings.h"
#include "vp/frame/frame.h"
#include "vp/frame/frame_tag.h"
#include "vp/frame/ledger.h"

namespace hvp::vp {

// The data acquisition board on the PCI bus, and the haptic devices behind it. Registers: a command
// that latches all positions, the latched positions, and the forces; one block each, of three words
// for each device. The counters latch at once; the words can be read after the sampling delay.
// Forces drive their devices after the output delay and the host's own, `delay`.
class DaqBoard : public sc_core::sc_module {
 public:
  static constexpr std::uint64_t kLatch = 0x00;  // a write of 4 bytes latches
  // 12 bytes for each device: x, y, z in plant::kPosition, and in plant::kForce. The currents of
  // the motors that have an ADC follow the positions, in the devices' order, in plant::kCurrent.
  static constexpr std::uint64_t kPosition = 0x100;  // read as a whole
  static constexpr std::uint64_t kForce = 0x300;     // written as a whole
  static constexpr std::uint64_t kSize = 0x400;
  static constexpr std::size_t kMostDevices = 16;
  // The length of the block that is read.
  static std::size_t read_bytes(const std::vector<const plant::DeviceSettings*>& devices);

  // `settings` has one for each device. Keeps references to the devices, the session and the
  // ledger. The devices' time is the session's.
  DaqBoard(const sc_core::sc_module_name& name, const plant::Daq& board,
           const std::vector<const plant::DeviceSettings*>& settings,
           const std::vector<plant::Device*>& devices, const Session& session, Ledger& ledger,
           Picoseconds delay = 0);

  tlm_utils::simple_target_socket<DaqBoard> from_bus;

 private:
  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  void latch(Tag& tag);
  void put_out(const unsigned char* words, const Tag& tag);

  // The board's channels to and from a device.
  struct Channel {
    Channel(const plant::DeviceSettings& settings, plant::Device& behind);

    plant::Encoder::Reading read() const;
    Eigen::Vector3d read_currents(const plant::PlantState& plant) const;
    plant::Drive driven(const Eigen::Vector3d& force) const;

    std::optional<plant::Encoder> encoder;
    std::optional<plant::DeviceLimits> limits;
    std::optional<plant::Adc> adc;
    std::unique_ptr<plant::Kinematics> kinematics;
    plant::OutputStage stage;
    plant::Device* device;
    Eigen::Vector3d tip = Eigen::Vector3d::Zero();  // true position at the last latch
  };

  // The frame's records of the devices; null without a frame or if no device has mass.
  DeviceRecord* records(const Tag& tag);

  std::vector<Channel> channels_;  // one a device
  const Session& session_;
  Ledger& ledger_;
  Picoseconds sampling_;
  Picoseconds output_;
  Picoseconds delay_;
  std::vector<std::int32_t> latched_;
  bool moving_;  // a device has mass
};

}  // namespace hvp::vp
