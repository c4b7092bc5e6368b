// Pictures and records as numpy arrays.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "records/image.h"

namespace postlens::python {

using Pixels = pybind11::array_t<float, pybind11::array::c_style>;

/// (height, width, 3) floats, or 4 with alpha. Takes the picture's memory over where it has no alpha.
[[nodiscard]] pybind11::array array_of(Image image);
/// A picture of (height, width, 3 or 4) floats, whose colours are radiance times 2^exposure_stops.
[[nodiscard]] Image image_of(const Pixels& pixels, const std::optional<double>& exposure_stops);

/// Adds `Records` and `read_records` to the module.
void add_records(pybind11::module_& module);

}  // namespace postlens::python
