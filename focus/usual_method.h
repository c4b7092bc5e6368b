// The default method of making an image.
#pragma once

#include <string_view>

#include "focus/focus.h"

namespace postlens {

struct UsualMethod {
    FocusMethod method = FocusMethod::layers;
    std::string_view reason;  ///< for messages, in the form "as the file has ..."
};

/// Returns the default method for a sample file: `layers` if it contains hidden surfaces, mirrors or glass,
/// otherwise `scatter`.
[[nodiscard]] UsualMethod usual_method(const SampleHeader& header);
/// Returns the default method for an image of another program, `layers`.
[[nodiscard]] UsualMethod usual_method_of_foreign_picture();

}  // namespace postlens
