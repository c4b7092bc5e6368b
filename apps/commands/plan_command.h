// Makes images with a target error (method auto) for `focus`, `shoot` and `motionblur`, and reports predicted
// errors.
#pragma once

#include "apps/command.h"
#include "planner/auto_picture.h"
#include "planner/predicted_error.h"

namespace postlens {

/// Makes an image by the method `auto`, with as many views (images seen from single lens points) and rays as
/// are needed for the target PSNR. If the target is not reached, sets the exit code of the result `out`.
/// `picture` is the path of the output image. Throws if the scene refers to this file.
[[nodiscard]] AutoResult run_auto(FocusFrame& frame, AutoSettings settings, const RetraceOptions& retrace,
                                  const std::string& picture, CommandResult& out);
/// Adds the predicted error of an image to the text and JSON of the result (option --predict).
void report_prediction(const PredictedError& predicted, CommandResult& out);
/// Returns the numbers that `--json` lists only for the method auto.
[[nodiscard]] nlohmann::ordered_json auto_json(const AutoResult& result);

}  // namespace postlens
