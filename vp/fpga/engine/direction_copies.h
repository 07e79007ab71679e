#pragma once

#include <cstdint>
#include <vector>

#include "models/accel/architecture.h"

namespace hvp::vp::engine {

// The nodes of a vector that are written into the copies at one edge.
struct DirectionWrite {
  int first = 0;
  int count = 0;
  std::uint32_t number = 0;             // counts the writes, so that none is taken twice
  const std::int32_t* words = nullptr;  // three a node
};

// The copies of the multiplied vector d, one in each SpMxV block. All take the same words at the
// same edges, so that one array stands for all, but for words whose bits have flipped in one of
// them.
class DirectionCopies {
 public:
  // All words become zero.
  void load(int nodes);
  // The copies' second ports, at an edge: nodes that the vector unit has written at the edge
  // before.
  void clocked(const DirectionWrite& write);
  // From now on bits may flip. A memory whose ports serve both reads and writes has a register in
  // front of them and writes an edge later, which shows by nothing else.
  void carry_words(accel::DirectionMemory memory);
  int copies_in_partition() const { return copies_; }
  int copy(int partition, int number) const { return copies_ * partition + number; }

  // Three a node, without what has flipped.
  const std::vector<std::int32_t>& words() const { return words_; }
  // A word of a copy; zero at a node that the system does not have.
  std::int32_t word(int copy, int node, int component) const;
  // Flips a bit of a word of so many bits, until the word is written again.
  void flip(int copy, int node, int component, int bit, int bits);

  // The words for a product, during which none is written.
  struct Operand {
    // Of the words' magnitudes: all lie in [−2^bits, 2^bits).
    int bits = 0;
    // Four a node, the last of them zero; meaningless where the words have more bits.
    std::vector<std::int16_t> narrow;
  };
  const Operand& operand();

 private:
  struct Deviation {
    int copy = 0;
    std::size_t place = 0;  // in words_
    std::int32_t word = 0;
  };

  void write(int first, int count, const std::int32_t* words);

  std::vector<std::int32_t> words_;
  int copies_ = 1;  // in a partition
  bool late_ = false;
  // What is written with the next edge.
  DirectionWrite waiting_;
  std::vector<std::int32_t> waiting_words_;
  std::vector<Deviation> deviations_;
  Operand operand_;
  bool operand_is_new_ = false;  // made since a word was written
  std::uint32_t written_ = 0;
};

}  // namespace hvp::vp::engine
