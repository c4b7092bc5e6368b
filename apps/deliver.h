// Where the picture goes that a command has made.
#pragma once

#include <optional>
#include <string>

#include "apps/command.h"
#include "records/image.h"

namespace postlens {

/// Before the work: refuses an output that write_image cannot write.
void check_output(const std::string& output);

/// Writes the picture, or leaves it in the result where `output` is empty; then as `report_picture`.
void deliver(Image image, const std::string& output, const std::optional<Crop>& crop, CommandResult& out);

/// Says in the result what part of the picture was made and what its exposure is, and warns where a PNG, TIFF
/// or JPEG shows little of it.
void report_picture(const Image& image, const std::string& output, const std::optional<Crop>& crop,
                    CommandResult& out);

}  // namespace postlens
