// Runs the method auto and reports predicted errors, for `focus`, `shoot` and `sweep`.
#pragma once

#include "apps/command.h"
#include "planner/auto_picture.h"
#include "planner/predicted_error.h"

namespace postlens {

/// Runs the method auto with the scene of `retrace`, and adds the warnings of the scene. If `retrace` names
/// an explanation image, writes it. Sets the exit code if the image does not reach the target PSNR. Throws if
/// the scene refers to the output file `picture`.
[[nodiscard]] AutoResult run_auto(FocusFrame& frame, AutoSettings settings, const RetraceOptions& retrace,
                                  const std::string& picture, CommandResult& out);
/// Adds the predicted error of an image to the result, as the option `--predict` asks for.
void report_prediction(const PredictedError& predicted, CommandResult& out);
/// Returns the numbers that `--json` lists only for the method auto.
[[nodiscard]] nlohmann::ordered_json auto_json(const AutoResult& result);

}  // namespace postlens
