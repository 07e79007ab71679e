#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/fit/fit_request.h"

namespace hvp::app {

// Fits each log by itself and puts together what they say (models/fit/between_logs.h); `request_of`
// gives the request of a log. With one log that is its fit, with a note of what its intervals leave
// out. Throws InputError for a log that is given twice, for several logs of a model that has one,
// and for logs that give different parameters.
FitOutcome fit_logs(const FitModel& model, const std::vector<std::filesystem::path>& logs,
                    const std::function<FitRequest(const std::filesystem::path&)>& request_of);

}  // namespace hvp::app
