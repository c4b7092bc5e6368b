// Helpers for the method auto and for error prediction, which `focus`, `shoot` and `sweep` use.
#pragma once

#include "apps/command.h"
#include "planner/auto_picture.h"
#include "planner/predicted_error.h"

namespace postlens {

/// Runs the method auto with the scene of `retrace` and adds the scene's warnings. Writes the explanation
/// image if `retrace` names one. Sets the exit code if the image does not reach the target PSNR. Throws an
/// error if the scene refers to the output file `picture`.
[[nodiscard]] AutoResult run_auto(FocusFrame& frame, AutoSettings settings, const RetraceOptions& retrace,
                                  const std::string& picture, CommandResult& out);
/// Adds the predicted error of an image to the result, for the option `--predict`.
void report_prediction(const PredictedError& predicted, CommandResult& out);
/// The numbers that `--json` lists only for the method auto.
[[nodiscard]] nlohmann::ordered_json auto_json(const AutoResult& result);

}  // namespace postlens
