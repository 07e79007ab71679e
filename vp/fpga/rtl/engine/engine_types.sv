// Names that several modules of the engine share.
package engine_types;

  // The passes of the vector unit over all nodes (thesis Fig. 4.4), as engine::Pass has them.
  typedef enum logic [2:0] {
    NoPass,
    Copy,            // x into the copies of d
    Guess,           // the same with x on the line through the last two solutions
    Product,         // group a: rows that the partitions finish become q, and their part of d.q
    Residual,        // r = b - q, and r.r
    FirstDirection,  // d = r
    Update,          // group b: x, r and r.r
    Direction        // group c: d = r + beta d
  } pass_t;

  // The states of a solve, in the order of engine::State.
  typedef enum logic [3:0] {
    InIdle,
    InCopy,
    InGuess,
    InStartProduct,
    InStartResidual,
    InFirstDirection,
    InProduct,
    InAlpha,
    InUpdate,
    InAnewProduct,
    InAnewResidual,
    InBeta,
    InDirection
  } state_t;

  // How dropped bits round; all kinds act on the magnitude (fixed::Rounding).
  typedef enum logic [1:0] {
    NearestEven,
    NearestUp,
    Truncation
  } rounding_t;

  // What the host addresses. A matrix address is {partition, row of the package, package}, each in
  // 16, 2 and 14 bits; an index address is the same without a row.
  typedef enum logic [3:0] {
    SpaceSettings,  // a register of engine_settings.sv
    SpaceColumn,    // a word of the package's row that the next SpaceMatrix writes
    SpaceMatrix,    // that row, into the matrix memory
    SpaceNode,      // a node of the index word that the next SpaceIndex writes
    SpaceIndex,     // that word, with {last, phase, owner} as data
    SpacePackages,  // the packages of the partition at the address
    SpaceX,         // a word of x: the address is {node, component}, the latter in two bits
    SpaceB,
    SpacePlace,     // where a node's row lies: the address is {packages, node} in 16 bits each, the
                    // word {blocks, partition, first package} in 8, 8 and 16
    SpaceContact,   // whether the node at the address is a contact node
    SpaceStaged     // the row that comes back: the address is {block, entry}, the latter in four
                    // bits; after nine words of a block, in the order of its pattern, entry 15
  } space_t;

  // The bits of |b * 2^static_shift - q * 2^product_shift|.
  function automatic int difference_bits(input int vector_bits, input int static_bits,
                                         input int product_bits, input int product_shift);
    automatic int of_b = vector_bits - 1 + 2 ** static_bits - 1;
    automatic int of_q = product_bits - 1 + product_shift;
    return (of_b > of_q ? of_b : of_q) + 1;
  endfunction

endpackage
