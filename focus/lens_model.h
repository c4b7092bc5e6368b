// Impulse responses of a real lens, as kernels.
#pragma once

#include <memory>
#include <optional>

#include "focus/focus.h"
#include "focus/responses/response_model.h"
#include "focus/scatter/splat_tables.h"
#include "lens/traced/lens_view.h"

namespace postlens {

/// Prepares the real lens of `settings.impulse` for an image of this size. Returns nothing if the impulse
/// response is not that of a real lens. `recorded` is the window of the recorded pixel corners. Throws if the
/// prescription cannot be read or the lens cannot be focused.
[[nodiscard]] std::optional<LensView> real_lens(const FocusSettings& settings, const Film& film,
                                                ImageSize picture, const RasterWindow& recorded);

/// Creates the model of a real lens from a table of rays traced through it.
/// - `geometry`: the geometry of `view`, in px of the traced image
/// - `half_diagonal_px`: half the diagonal of the recorded area, including overscan
[[nodiscard]] std::unique_ptr<ResponseModel> lens_model(const LensView& view, const FocusGeometry& geometry,
                                                        double half_diagonal_px,
                                                        double largest_inverse_depth_per_m);

}  // namespace postlens
