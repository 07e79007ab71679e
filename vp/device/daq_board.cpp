#include "vp/device/daq_board.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

namespace hvp::vp {

DaqBoard::Channel::Channel(const plant::DeviceSettings& settings, plant::Device& behind)
    : encoder(settings.encoder),
      limits(settings.limits),
      adc(settings.adc),
      kinematics(settings.kinematics ? plant::make_kinematics(*settings.kinematics) : nullptr),
      stage(settings.dac, settings.amplifier, settings.motor, kinematics.get()),
      device(&behind) {}

std::size_t DaqBoard::read_bytes(const std::vector<const plant::DeviceSettings*>& devices) {
  std::size_t bytes = 0;
  for (const plant::DeviceSettings* device : devices) bytes += device->adc ? 24 : 12;
  return bytes;
}

DaqBoard::DaqBoard(const sc_core::sc_module_name& name, const plant::Daq& board,
                   const std::vector<const plant::DeviceSettings*>& settings,
                   const std::vector<plant::Device*>& devices, const Session& session,
                   Ledger& ledger, Picoseconds delay)
    : sc_module(name),
      from_bus("from_bus"),
      session_(session),
      ledger_(ledger),
      sampling_(to_picoseconds(board.sampling_delay)),
      output_(to_picoseconds(board.output_delay)),
      delay_(delay),
      latched_(read_bytes(settings) / 4),
      moving_(std::ranges::any_of(devices, [](const auto* d) { return d->has_mass(); })) {
  channels_.reserve(devices.size());
  for (std::size_t i = 0; i < devices.size(); ++i) {
    channels_.emplace_back(*settings.at(i), *devices[i]);
  }
  from_bus.register_b_transport(this, &DaqBoard::b_transport);
}

void DaqBoard::b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& /*delay*/) {
  Tag none;
  Tag& tag = tag_of(transaction, none);
  const std::uint64_t address = transaction.get_address();
  const unsigned bytes = transaction.get_data_length();
  transaction.set_response_status(tlm::TLM_OK_RESPONSE);

  if (transaction.is_write() && address == kLatch && bytes == 4) {
    latch(tag);
  } else if (transaction.is_read() && address == kPosition && bytes == 4 * latched_.size()) {
    std::memcpy(transaction.get_data_ptr(), latched_.data(), bytes);
  } else if (transaction.is_write() && address == kForce && bytes == 12 * channels_.size()) {
    put_out(transaction.get_data_ptr(), tag);
  } else {
    transaction.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
  }
}

void DaqBoard::latch(Tag& tag) {
  const Picoseconds start = now_ps();
  DeviceRecord* record = records(tag);
  if (tag.frame >= 0) ledger_.frame(tag.frame).latched = start;
  std::size_t currents = 3 * channels_.size();  // the next word of a current
  for (std::size_t d = 0; d < channels_.size(); ++d) {
    Channel& channel = channels_[d];
    channel.tip = channel.device->at(start - session_.begin).position;
    plant::Encoder::Reading reading = channel.read();
    for (std::size_t i = 0; i < 3; ++i) {
      const plant::Counts counts =
          plant::kPosition.to_counts(reading.position[static_cast<Eigen::Index>(i)]);
      latched_[3 * d + i] = counts.value;
      reading.wrong = reading.wrong || counts.saturated;
    }
    if (record == nullptr && !channel.adc) continue;
    const plant::PlantState plant = channel.device->plant();
    const Eigen::Vector3d current = channel.read_currents(plant);
    for (int i = 0; channel.adc && i < 3; ++i) {
      latched_[currents++] = plant::kCurrent.to_counts(current[i]).value;
    }
    if (record == nullptr) continue;
    record[d].plant = plant;
    record[d].read_wrong = reading.wrong;
    record[d].read_current = current;
  }
  wait(to_sc_time(sampling_));
  ledger_.extend(tag, Part::daq, Phase::sample, start, now_ps());
}

DeviceRecord* DaqBoard::records(const Tag& tag) {
  if (!moving_ || tag.frame < 0) return nullptr;
  std::vector<DeviceRecord>& records = ledger_.frame(tag.frame).devices;
  records.resize(channels_.size());
  return records.data();
}

plant::Encoder::Reading DaqBoard::Channel::read() const {
  if (!encoder) return {tip, false};
  return encoder->read(tip, kinematics.get());
}

// Zero without an ADC.
Eigen::Vector3d DaqBoard::Channel::read_currents(const plant::PlantState& plant) const {
  if (!adc) return Eigen::Vector3d::Zero();
  return stage.currents(plant.motor_force, plant.tip.position).unaryExpr([this](double current) {
    return adc->read(current);
  });
}

plant::Drive DaqBoard::Channel::driven(const Eigen::Vector3d& force) const {
  plant::Drive drive = stage.drive(force, tip);
  if (!limits) return drive;
  const double limit = limits->force_N;
  const double asked = force.norm();
  const bool clamped = asked > limit;
  if (clamped) drive = stage.drive(force * (limit / asked), tip);
  // A converter that rounds to its nearest step may round beyond the limit: the largest part of the
  // force that it does not.
  constexpr double kRounding = 1e-9;
  constexpr int kShares = 64;
  for (int part = kShares - 1; part >= 0 && drive.force.norm() > (1 + kRounding) * limit; --part) {
    const double share = static_cast<double>(part) / kShares;
    drive = stage.drive(force * (share * std::min(1.0, limit / asked)), tip);
  }
  drive.current_saturated = drive.current_saturated || clamped;
  return drive;
}

// The converter works on while the host does; nobody waits for it, so that no event is due.
void DaqBoard::put_out(const unsigned char* words, const Tag& tag) {
  const Picoseconds start = now_ps();
  const Picoseconds settled = start + output_;
  const Picoseconds there = settled + delay_;
  DeviceRecord* record = records(tag);
  for (std::size_t d = 0; d < channels_.size(); ++d) {
    std::array<std::int32_t, 3> counts{};
    std::memcpy(counts.data(), words, sizeof(counts));
    words += sizeof(counts);
    const Eigen::Vector3d force(plant::kForce.to_value(counts[0]),
                                plant::kForce.to_value(counts[1]),
                                plant::kForce.to_value(counts[2]));
    const plant::Drive drive = channels_[d].driven(force);
    channels_[d].device->drive(there - session_.begin, drive.force, force);
    if (record != nullptr) record[d].drive = drive;
  }
  Tag output = tag;
  ledger_.extend(output, Part::daq, Phase::convert, start, settled);
  if (delay_ > 0) ledger_.extend(output, Part::host, Phase::delay, settled, there);
  ledger_.extend(output, Part::device, Phase::motor, there, there);
  ledger_.force_at_motor(output);
}

}  // namespace hvp::vp
