#pragma once

namespace hvp::collision::test {

// How often this program has called operator new.
long allocations();

}  // namespace hvp::collision::test
