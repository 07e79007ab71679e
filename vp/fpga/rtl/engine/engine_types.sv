// Names that several modules of the engine share.
package engine_types;

  // The passes of the vector unit over all nodes (thesis Fig. 4.4), as engine::Pass has them.
  typedef enum logic [2:0] {
    NoPass,
    Copy,            // x into the copies of d
    Guess,           // the same with x on the line through the last two solutions
    Product,         // group a: rows that the partitions finish become q, and their part of d.q
    Residual,        // r = b - q, z = P^-1 r, and z.r
    FirstDirection,  // d = z
    Update,          // group b: x, r, z and z.r
    Direction        // group c: d = z + beta d
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

  // With a preconditioner (fixed::Settings): the bits of r, z and b, to how many of them dynamic
  // scaling brings r, and the bits of P^-1 beyond those of the matrix.
  /* verilator lint_off UNUSEDPARAM */  // in a module that is translated on its own
  localparam int WideBits = 32;
  localparam int WideTarget = 25;
  localparam int InverseBits = 18;
  /* verilator lint_on UNUSEDPARAM */

  // A row of P^-1: of the inverse diagonal one word, of inverse blocks three with a sign.
  function automatic int inverse_words(input int preconditioner);
    return preconditioner == 2 ? 3 : 1;
  endfunction
  function automatic int inverse_bits(input int preconditioner);
    return preconditioner == 2 ? WideBits : WideBits - 1;
  endfunction

  // Places behind the point of the words that align a product with a coefficient, whose mantissa
  // has its highest bit: one that is shifted to the left by more is beyond every word.
  function automatic int below_products(input int word_bits, input int coefficient_bits);
    return word_bits > coefficient_bits ? word_bits - coefficient_bits + 1 : 2;
  endfunction

  // The bits of z where it is aligned to be d. Without dynamic scaling it may be shifted to the left:
  // by q's dropped bits and P^-1's longest word, less the bits by which P^-1 is scaled.
  // A word of the inverse diagonal is not longer than that scale, a row of an inverse block is.
  function automatic int direction_bits(input int preconditioner, input int vector_bits,
                                        input int matrix_bits, input int product_shift);
    automatic int scale = matrix_bits + InverseBits;
    automatic int longest = preconditioner == 1 && scale + 1 < WideBits - 1 ? scale + 1
                                                                            : WideBits - 1;
    automatic int left = product_shift + longest - scale;
    if (preconditioner == 0) return vector_bits;
    return WideBits + (left > 0 ? left : 0);
  endfunction

  // The bits of |b * 2^static_shift - q * 2^product_shift|.
  function automatic int difference_bits(input int vector_bits, input int static_bits,
                                         input int product_bits, input int product_shift);
    automatic int of_b = vector_bits - 1 + 2 ** static_bits - 1;
    automatic int of_q = product_bits - 1 + product_shift;
    return (of_b > of_q ? of_b : of_q) + 1;
  endfunction

endpackage
