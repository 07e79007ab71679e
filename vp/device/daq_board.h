#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <systemc>

#include <tlm_utils/simple_target_socket.h>

#include "models/plant/device.h"
#include "models/plant/device_settings.h"
#include "vp/frame/frame_tag.h"
#include "vp/frame/ledger.h"
#include "vp/frame/session.h"

namespace hvp::vp {

// The data acquisition board on the PCI bus, and the haptic device behind it. Three registers: a
// command that latches the position, the latched position, and the force. The counters latch at
// once; the word can be read after the sampling delay. A force drives the device after the output
// delay (the amplifier adds none yet), and after the host's own where it has one: `delay`.
class DaqBoard : public sc_core::sc_module {
 public:
  static constexpr std::uint64_t kLatch = 0x00;     // write 4 bytes: latch now
  static constexpr std::uint64_t kPosition = 0x10;  // read 12 bytes: x, y, z in plant::kPosition
  static constexpr std::uint64_t kForce = 0x20;     // write 12 bytes: x, y, z in plant::kForce
  static constexpr std::uint64_t kSize = 0x40;

  // Keeps references to the device, whose times are the session's, the session and the ledger.
  DaqBoard(const sc_core::sc_module_name& name, const plant::DeviceSettings& settings,
           plant::Device& device, const Session& session, Ledger& ledger, Picoseconds delay = 0);

  tlm_utils::simple_target_socket<DaqBoard> from_bus;

 private:
  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  void latch(Tag& tag);
  void put_out(const unsigned char* words, const Tag& tag);

  std::optional<plant::Encoder> encoder_;
  plant::Device& device_;
  const Session& session_;
  Ledger& ledger_;
  Picoseconds sampling_;
  Picoseconds output_;
  Picoseconds delay_;
  std::array<std::int32_t, 3> latched_{};
};

}  // namespace hvp::vp
