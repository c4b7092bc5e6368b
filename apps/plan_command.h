// What `focus`, `shoot` and `sweep` have in common where something decides pixel by pixel.
#pragma once

#include "apps/command.h"
#include "planner/auto_picture.h"
#include "planner/predicted_error.h"

namespace postlens {

/// `auto`, with the scene that `retrace` names, which may not need the `picture` that is to be written;
/// writes its picture of what was done, adds the scene's warnings, and sets the exit code for a target that
/// is not met.
[[nodiscard]] AutoResult run_auto(FocusFrame& frame, AutoSettings settings, const RetraceOptions& retrace,
                                  const std::string& picture, CommandResult& out);
/// `--predict`: adds what is expected of a picture to what is said of it.
void report_prediction(const PredictedError& predicted, CommandResult& out);
/// What `--json` says of `auto` beside what it says of every picture.
[[nodiscard]] nlohmann::ordered_json auto_json(const AutoResult& result);

}  // namespace postlens
