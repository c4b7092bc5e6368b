// Which method to take where nobody asked for one.
#pragma once

#include <string_view>

#include "focus/focus.h"

namespace postlens {

struct UsualMethod {
    FocusMethod method = FocusMethod::layers;
    std::string_view reason;  ///< "as the file has ..."
};

/// `layers` where the file has hidden surfaces, or mirrors or glass; else `scatter`. By random scenes and the
/// samples (docs/focus.md): with hidden surfaces `layers` is ahead of the other two on most scenes; without,
/// what a blurred edge uncovers is a guess, and the mean that `scatter` takes is the safer one.
[[nodiscard]] UsualMethod usual_method(const SampleHeader& header);
/// Of a picture of another program: `layers`.
[[nodiscard]] UsualMethod usual_method_of_foreign_picture();

}  // namespace postlens
