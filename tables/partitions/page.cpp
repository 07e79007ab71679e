#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include "models/accel/cycles.h"
#include "models/accel/partition.h"
#include "models/accel/several_devices.h"
#include "tables/hard_cases/bodies.h"
#include "tables/pages.h"
#include "tables/text.h"

namespace hvp::tables {

namespace {

constexpr int kMostParts = 16;
constexpr double kHeld = 0.15;  // of the nodes, the lowest; as scenarios/thesis.toml

constexpr const char* kHead = R"(# Partitions of K

<!-- Made by `./hvp tables partitions > docs/partitions.md`: do not edit. -->

Code: `models/accel/partition.h` (who has which rows, and what a partition does to
the zeros). What several devices do with their rows is in [several-devices.md](several-devices.md).

<!-- not run: writes into the checkout -->
```sh
./hvp tables partitions > docs/partitions.md
```

## How many zeros a partition isolates

Thesis §5.2: if METIS reorders the nodes so that non-zeros gather in blocks along the diagonal, the zeros
outside the blocks need neither memory nor time, and inside a block no index. "Typically no more than 60 %
of the zeros may be isolated", while 97 % of the entries are zeros: so the thesis stores non-zeros with
indices instead.

k parts by METIS' recursive bisection, of the sphere of §6.2.4 with its lowest 15 % of nodes removed.
*Square*: a part's rows by its own columns; zeros outside are isolated, but so are the non-zeros that tie
two parts together, and those have to be kept some other way. *Overlapping* (Fig. 5.2): a part's rows by every
column that they touch, which leaves out no non-zero. *Halo*: columns of other parts, of the part that touches
most. *Stored*: entries inside the overlapping blocks over non-zeros, that is how many times the memory and
the multiplications of the packages without their padding.
)";

constexpr const char* kComparison = R"(
**Beside the thesis' figure.** The thesis says neither how many parts it took nor whether its blocks overlap. Square
blocks isolate about 1 − 1/k by arithmetic, without a bound; but what lies outside them is not only zeros. Overlapping
blocks, which alone can be multiplied by themselves, isolate )";

constexpr const char* kBalanceHead = R"(
## How even the parts are

Packages of the fullest part over the mean, less one: the clocks that a product loses. *Dealt*: longest row first
to the part that has least (§5.3), which `models/accel` does for the partitions of one device and for several
devices that exchange everything. METIS keeps a bisection even to a thousandth as far as whole rows allow, so
that errors add up where k is no power of two.
)";

constexpr const char* kDevicesHead = R"(
## What several devices send each other

Words of d that cross the links in an exchange, and clocks of the links in an iteration of CG, for the links that
[several-devices.md](several-devices.md) assumes: `exchange = "all"` with dealt rows against `"halo"` with METIS'.
)";

accel::Pattern pattern_of_sphere(int nodes) {
  const mesh::TetMesh& mesh = sphere(nodes);
  const Body body = make_body(mesh, {}, lowest_nodes(mesh, kHeld));
  return accel::pattern_of(body.stiffness.row_begin, body.stiffness.column);
}

std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }

accel::Isolation isolation(const accel::Pattern& p, int parts) {
  return accel::isolation_of(p, accel::metis_parts({}, p, parts), parts);
}

std::string isolation_table(const accel::Pattern& p) {
  MarkdownTable table({"k", "square: zeros isolated", "non-zeros outside",
                       "overlapping: zeros isolated", "largest halo", "stored"});
  for (int parts = 2; parts <= kMostParts; ++parts) {
    const accel::Isolation i = isolation(p, parts);
    const double inside = static_cast<double>(i.zeros - i.zeros_outside_touched + i.nonzeros);
    table.add({std::to_string(parts), percent(i.isolated()), percent(i.cut()),
               percent(i.isolated_by_overlapping()), std::to_string(i.largest_halo),
               fmt::format("{:.1f}×", inside / static_cast<double>(i.nonzeros))});
  }
  return table.text();
}

std::string comparison(const accel::Pattern& p) {
  // The k up to which overlapping blocks isolate no more than the thesis' 60 %.
  int parts = 1;
  while (parts < kMostParts && isolation(p, parts + 1).isolated_by_overlapping() <= 0.6) ++parts;
  const accel::Architecture a;
  const std::int64_t packages =
      accel::balance_of(a, p, std::vector<int>(p.blocks_in_row.size(), 0), 1).fullest;
  const double padding =
      static_cast<double>(packages * a.package) / static_cast<double>(3 * isolation(p, 1).nonzeros);
  const auto share = [&p](int k) { return percent(isolation(p, k).isolated_by_overlapping()); };
  return fmt::format(
      "{}{}\nof the zeros of the smaller mesh with {} parts and {} with {}: the thesis' 60 % is "
      "what such a small k gives, not\na bound. With the thesis' five partitions it is {}, with "
      "{} parts {}. The conclusion of §5.2 holds all the same:\neven there the blocks store and "
      "multiply several times the non-zeros, the packages with their padding {:.2f} times.\n",
      kComparison, share(parts), parts, share(parts + 1), parts + 1, share(5), kMostParts,
      share(kMostParts), padding);
}

std::string balance_table(const std::vector<accel::Pattern>& meshes) {
  std::vector<std::string> heads = {"k"};
  for (const accel::Pattern& p : meshes) {
    heads.push_back(fmt::format("{} nodes, dealt", p.nodes()));
    heads.push_back("by METIS");
  }
  MarkdownTable table(heads);
  const accel::Architecture a;
  for (int parts = 2; parts <= kMostParts; ++parts) {
    std::vector<std::string> row = {std::to_string(parts)};
    for (const accel::Pattern& p : meshes) {
      for (const std::vector<int>& part :
           {accel::deal_rows(a, p, parts), accel::metis_parts(a, p, parts)}) {
        row.push_back(percent(accel::balance_of(a, p, part, parts).loss()));
      }
    }
    table.add(row);
  }
  return table.text();
}

std::string exchange_table(const std::vector<accel::Pattern>& meshes) {
  MarkdownTable table({"nodes", "devices", "words, all", "halo", "clocks of links, all", "halo",
                       "speed-up, all", "halo"});
  for (const accel::Pattern& p : meshes) {
    for (const int devices : {2, 4, 8}) {
      std::vector<std::string> words, clocks, speed_ups;
      for (const accel::Exchange exchange : {accel::Exchange::all, accel::Exchange::halo}) {
        accel::Architecture a;
        a.several = accel::Several{.devices = devices, .exchange = exchange};
        const accel::SeveralDevices board(a, p);
        const accel::SeveralCycles c = board.solve({});
        words.push_back(std::to_string(board.exchanged_words()));
        clocks.push_back(std::to_string(c.link_clocks_an_iteration()));
        const auto alone =
            static_cast<double>(accel::solve_cycles(accel::Architecture(), p, {}).total());
        speed_ups.push_back(fmt::format("{:.2f}", alone / static_cast<double>(c.solve.total())));
      }
      table.add({std::to_string(p.nodes()), std::to_string(devices), words[0], words[1], clocks[0],
                 clocks[1], speed_ups[0], speed_ups[1]});
    }
  }
  return table.text();
}

}  // namespace

std::string partitions_page() {
  const std::vector<accel::Pattern> meshes = {pattern_of_sphere(500), pattern_of_sphere(1000)};
  std::string page = kHead;
  for (const accel::Pattern& p : meshes) {
    const accel::Isolation whole = isolation(p, 1);
    page += fmt::format("\n{} nodes, {:.1f} blocks a row, {} of the entries zero:\n\n", p.nodes(),
                        static_cast<double>(whole.nonzeros) / p.nodes(), percent(whole.sparsity()));
    page += isolation_table(p);
  }
  page += comparison(meshes[0]);
  page += kBalanceHead;
  page += "\n" + balance_table(meshes);
  page += kDevicesHead;
  page += "\n" + exchange_table(meshes);
  return page;
}

}  // namespace hvp::tables
