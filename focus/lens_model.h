// Impulse responses of a real lens, in the form that scattering wants.
#pragma once

#include <memory>
#include <optional>

#include "focus/focus.h"
#include "focus/response_model.h"
#include "focus/splat_tables.h"
#include "lens/prescription/lens_view.h"

namespace postlens {

/// The real lens of `settings.impulse`, set up for a picture of this size whose records have corners in
/// `recorded`; none for other impulse responses. Throws what reading and focusing the prescription throw.
[[nodiscard]] std::optional<LensView> real_lens(const FocusSettings& settings, const Film& film,
                                                ImageSize picture, const RasterWindow& recorded);

/// From a table of traced rays (lens/prescription/fan_table.h). `geometry`: the view's, in the px that the
/// picture is scattered in. `half_diagonal_px`: of all that was recorded.
[[nodiscard]] std::unique_ptr<ResponseModel> lens_model(const LensView& view, const FocusGeometry& geometry,
                                                        double half_diagonal_px,
                                                        double largest_inverse_depth_per_m);

}  // namespace postlens
