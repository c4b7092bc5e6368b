// Impulse responses of a real lens, as kernels.
#pragma once

#include <memory>
#include <optional>

#include "focus/focus.h"
#include "focus/responses/response_model.h"
#include "focus/scatter/splat_tables.h"
#include "lens/traced/lens_view.h"

namespace postlens {

/// Reads the real lens that `settings.impulse` describes, and focuses it at the distance in `settings`.
/// Returns nothing if `settings.impulse` does not describe a real lens. Throws if the lens cannot be read or
/// focused.
/// - `recorded`: pixel corners of the traced area, including overscan; rays are traced up to its corners
[[nodiscard]] std::optional<LensView> real_lens(const FocusSettings& settings, const Film& film,
                                                ImageSize picture, const RasterWindow& recorded);

/// Creates the model that computes the blur kernels of a real lens. It traces rays through the lens once, and
/// stores them in a table.
/// - `geometry`: lens geometry of `view`; lengths on the film are in px of the sample file
/// - `half_diagonal_px`: half the diagonal of the traced area (image and overscan), up to which the table
///   extends
/// - `largest_inverse_depth_per_m`: 1 / depth of the nearest surface, in 1/m
[[nodiscard]] std::unique_ptr<ResponseModel> lens_model(const LensView& view, const FocusGeometry& geometry,
                                                        double half_diagonal_px,
                                                        double largest_inverse_depth_per_m);

}  // namespace postlens
