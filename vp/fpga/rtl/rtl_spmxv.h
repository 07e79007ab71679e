#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <systemc>

#include "vp/fpga/engine/cycle_engine.h"

class Vspmxv;
class VerilatedContext;

namespace hvp::vp::rtl {

// The sub-block in SystemVerilog, spmxv.sv, through Verilator, beside one of the cycle-accurate
// engine: it has the same memories and gets the same inputs at every edge. The outputs of the two
// are compared at every edge.
class RtlSpmxv : public sc_core::sc_module {
 public:
  // The architecture has to be that of spmxv.sv; InputError names the key that differs.
  RtlSpmxv(const sc_core::sc_module_name& name, engine::CycleEngine& engine, int partition);
  ~RtlSpmxv() override;

  // To be called after the engine's load(), and whenever its matrix has changed.
  void load();

  std::int64_t edges() const { return edges_; }
  std::int64_t rows() const { return rows_; }
  // The first edge and output that differed, with both values; empty if none did.
  const std::string& difference() const { return difference_; }

 private:
  void clocked();
  void compare();
  void edge();
  void differs(const char* output, std::int64_t rtl, std::int64_t model);

  engine::CycleEngine& engine_;
  int partition_;
  std::unique_ptr<VerilatedContext> context_;
  std::unique_ptr<Vspmxv> rtl_;
  std::uint32_t started_ = 0;
  std::uint32_t written_ = 0;
  std::uint32_t shown_rows_ = 0;
  std::int64_t edges_ = 0;
  std::int64_t rows_ = 0;
  std::string difference_;
};

}  // namespace hvp::vp::rtl
