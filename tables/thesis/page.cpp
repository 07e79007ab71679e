#include "tables/thesis/page.h"
namespace hvp::tables {
std::string thesis_page() { return "todo"; }
std::string thesis_csv() { return "todo"; }
}  // namespace hvp::tables
