// Impulse responses with diffraction, as kernels.
#pragma once

#include <memory>
#include <vector>

#include "focus/responses/response_model.h"

namespace postlens {

/// Creates the model of a round aperture with diffraction, with one kernel per colour channel [potmesil1981].
/// If `wavelengths_nm` is empty, each channel uses its own band (lens/wave/spectrum.h). Throws
/// Error(wrong_arguments) if a wavelength is out of range.
///
/// A kernel contains 99 % of the light's energy, but extends at most 256 px beyond the circle of confusion.
/// Its values are scaled so that their sum is 1.
[[nodiscard]] std::unique_ptr<ResponseModel> diffraction_model(const std::vector<double>& wavelengths_nm,
                                                               const FocusGeometry& geometry);

}  // namespace postlens
