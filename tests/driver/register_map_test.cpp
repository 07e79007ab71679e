// The register map stands in three forms: driver/hvp.rdl, the C header and the C++ table. These
// tests read the first two as text and do not use the generator, so an error in it shows.
#include <algorithm>
#include <cstddef>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "driver/generated/hvp_registers.h"
#include "vp/fpga/register_table.h"

namespace {

using hvp::vp::kApertures;
using hvp::vp::kRegisters;

std::string text_of(const std::string& name) {
  std::ifstream file(std::string(HVP_SOURCE_DIR) + "/" + name);
  EXPECT_TRUE(file) << name;
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::uint32_t number(std::string digits) {
  std::erase(digits, '_');
  return static_cast<std::uint32_t>(std::stoul(digits, nullptr, 0));
}

std::map<std::string, std::uint32_t> offsets_in_table() {
  std::map<std::string, std::uint32_t> offsets;
  for (const auto& info : kRegisters) offsets[std::string(info.name)] = info.offset;
  for (const auto& info : kApertures) offsets[std::string(info.name)] = info.offset;
  return offsets;
}

TEST(RegisterMap, OffsetsOfTheDescriptionAreThoseOfTheTable) {
  const std::string text = text_of("driver/hvp.rdl");
  const std::regex instance(R"(\} ([A-Z_]+) @ (0x[0-9a-f_]+);)");
  std::map<std::string, std::uint32_t> described;
  for (std::sregex_iterator it(text.begin(), text.end(), instance), end; it != end; ++it) {
    described[(*it)[1]] = number((*it)[2]);
  }
  EXPECT_EQ(described, offsets_in_table());
}

TEST(RegisterMap, OffsetsOfTheHeaderAreThoseOfTheTable) {
  std::map<std::string, std::uint32_t> in_header;
#define OFFSET(name) in_header[#name] = static_cast<std::uint32_t>(offsetof(hvp_t, name))
  OFFSET(ID);
  OFFSET(VERSION);
  OFFSET(CAPABILITY_NODES);
  OFFSET(CAPABILITY_BLOCKS);
  OFFSET(CAPABILITY_FORMAT);
  OFFSET(CAPABILITY_CLOCK);
  OFFSET(CAPABILITY_SOLVER);
  OFFSET(CAPABILITY_DMA);
  OFFSET(CONTROL);
  OFFSET(STATUS);
  OFFSET(INTERRUPT_STATUS);
  OFFSET(INTERRUPT_ENABLE);
  OFFSET(ERROR);
  OFFSET(ERROR_DETAIL);
  OFFSET(JOB);
  OFFSET(METHOD);
  OFFSET(ITERATIONS);
  OFFSET(STOP_RESIDUAL_LOW);
  OFFSET(STOP_RESIDUAL_HIGH);
  OFFSET(REPLACE_EVERY);
  OFFSET(STATIC_SHIFT);
  OFFSET(SCALING);
  OFFSET(FORMAT);
  OFFSET(COEFFICIENTS);
  OFFSET(ARITHMETIC);
  OFFSET(START_MODE);
  OFFSET(NODES);
  OFFSET(BLOCKS);
  OFFSET(PACKING);
  OFFSET(UPDATE_NODE);
  OFFSET(UPDATE_KIND);
  OFFSET(UPDATE_DIAGONAL);
  OFFSET(UPDATE_BLOCKS);
  OFFSET(RESULT_JOB);
  OFFSET(RESULT_ITERATIONS);
  OFFSET(RESULT_END);
  OFFSET(RESULT_REPLACEMENTS);
  OFFSET(RESULT_SATURATIONS);
  OFFSET(RESULT_WRAPS);
  OFFSET(RESULT_BREAKDOWNS);
  OFFSET(RESULT_FLAGS);
  OFFSET(RESULT_CYCLES_LOW);
  OFFSET(RESULT_CYCLES_HIGH);
  OFFSET(DMA_LIST_LOW);
  OFFSET(DMA_LIST_HIGH);
  OFFSET(DMA_COUNT);
  OFFSET(DMA_RECORD_LOW);
  OFFSET(DMA_RECORD_HIGH);
  OFFSET(DMA_VALUES_LOW);
  OFFSET(DMA_VALUES_HIGH);
  OFFSET(DMA_VALUES_COUNT);
  OFFSET(ROW);
  OFFSET(B);
  OFFSET(U);
  OFFSET(ROW_BEGIN);
  OFFSET(COLUMN);
  OFFSET(VALUE);
#undef OFFSET
  EXPECT_EQ(in_header, offsets_in_table());
}

TEST(RegisterMap, MasksAndResetValuesOfTheHeaderAreThoseOfTheTable) {
  const std::string text = text_of("driver/generated/hvp_registers.h");
  std::map<std::string, std::uint32_t> mask;
  std::map<std::string, std::uint32_t> reset;
  const std::regex define(
      R"(#define HVP__([A-Z_]+?)__([A-Z_]+)_(bm|bp|reset) (0x[0-9a-f]+|[0-9]+))");
  std::uint32_t shift = 0;
  for (std::sregex_iterator it(text.begin(), text.end(), define), end; it != end; ++it) {
    const std::string reg = (*it)[1];
    const std::string kind = (*it)[3];
    const std::uint32_t value = number((*it)[4]);
    if (kind == "bm") {
      EXPECT_EQ(mask[reg] & value, 0U) << reg << "'s fields overlap";
      mask[reg] |= value;
    } else if (kind == "bp") {
      shift = value;
    } else {
      reset[reg] |= value << shift;
    }
  }
  ASSERT_EQ(mask.size(), kRegisters.size());
  for (const auto& info : kRegisters) {
    const std::string name(info.name);
    EXPECT_EQ(mask[name], info.read_mask | info.write_mask) << name;
    EXPECT_EQ(reset[name], info.reset) << name;
  }
}

TEST(RegisterMap, IdSaysHvp1) {
  EXPECT_EQ(kRegisters[0].reset, 0x48565031U);  // 'H' 'V' 'P' '1' in ASCII
}

TEST(RegisterMap, StatusIsNeverAllOnes) {
  const auto& status = kRegisters[static_cast<std::size_t>(hvp::vp::Register::status)];
  EXPECT_NE(status.read_mask, 0xffffffffU);
}

TEST(RegisterMap, MemoriesDoNotOverlapAndHoldWhatTheyMust) {
  std::uint32_t end = hvp::vp::kRegisterBytes;
  for (const auto& info : kApertures) {
    EXPECT_GE(info.offset, end) << info.name;
    end = info.offset + info.size;
  }
  EXPECT_LE(end, hvp::vp::kBarBytes);
  EXPECT_EQ(sizeof(hvp_t), end);
  // 8192 nodes, and 40 blocks a row on average.
  EXPECT_GE(sizeof(hvp__B_t), 8192U * 3 * 4);
  EXPECT_GE(sizeof(hvp__U_t), 8192U * 3 * 4);
  EXPECT_GE(sizeof(hvp__ROW_BEGIN_t), 8193U * 4);
  EXPECT_GE(sizeof(hvp__COLUMN_t), 8192U * 40 * 4);
  EXPECT_GE(sizeof(hvp__VALUE_t), 8192U * 40 * 9 * 4);
  EXPECT_GE(sizeof(hvp__ROW_t), 40U * 9 * 4);
}

TEST(RegisterMap, WhatSoftwareCannotWriteHasNoSideEffectOfWriting) {
  for (const auto& info : kRegisters) {
    EXPECT_EQ(info.write_one_to_clear_mask & ~info.write_mask, 0U) << info.name;
    EXPECT_EQ(info.pulse_mask & ~info.write_mask, 0U) << info.name;
    EXPECT_EQ(info.busy_mask & ~info.write_mask, 0U) << info.name;
    EXPECT_EQ(info.pulse_mask & info.read_mask, 0U) << info.name;
  }
}

}  // namespace
