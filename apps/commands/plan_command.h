// Helpers that `focus`, `shoot` and `sweep` share for the method auto and for error prediction.
#pragma once

#include "apps/command.h"
#include "planner/auto_picture.h"
#include "planner/predicted_error.h"

namespace postlens {

/// Runs auto with the scene of `retrace`, adds the scene's warnings, writes the explanation image if
/// `retrace` names one, and sets the exit code if the target PSNR is not met. `picture` is the output file;
/// an error is thrown if the scene refers to it.
[[nodiscard]] AutoResult run_auto(FocusFrame& frame, AutoSettings settings, const RetraceOptions& retrace,
                                  const std::string& picture, CommandResult& out);
/// `--predict`: adds the predicted error of an image to the result.
void report_prediction(const PredictedError& predicted, CommandResult& out);
/// The figures that `--json` lists for `auto` in addition to those of every image.
[[nodiscard]] nlohmann::ordered_json auto_json(const AutoResult& result);

}  // namespace postlens
