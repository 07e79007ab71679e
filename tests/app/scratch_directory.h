#pragma once

#include "app/process/temporary_folder.h"

namespace hvp {

// A folder of its own for one test.
using ScratchDirectory = app::TemporaryFolder;

}  // namespace hvp
