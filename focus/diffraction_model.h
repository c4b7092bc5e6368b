// Impulse responses by waves, in the form that scattering wants.
#pragma once

#include <memory>
#include <vector>

#include "focus/response_model.h"

namespace postlens {

/// The round aperture's, each colour channel with its own [potmesil1981]. `wavelengths_nm`: of all channels;
/// empty: their own bands (lens/wave/spectrum.h). A kernel holds 99 % of its energy where that lies within
/// 256 px of the geometric edge, and is made 1 in sum. Throws Error(wrong_arguments) for wavelengths out of
/// range.
[[nodiscard]] std::unique_ptr<ResponseModel> diffraction_model(const std::vector<double>& wavelengths_nm,
                                                               const FocusGeometry& geometry);

}  // namespace postlens
