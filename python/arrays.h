// Converts images and records to and from numpy arrays.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "pictures/image.h"

namespace postlens::python {

using Pixels = pybind11::array_t<float, pybind11::array::c_style>;

/// Returns an array of (height, width, 3) floats, or 4 with alpha. Without alpha, the array takes over the
/// image's memory.
[[nodiscard]] pybind11::array array_of(Image image);
/// Returns an image from an array of (height, width, 3 or 4) floats: radiance times 2^exposure_stops.
[[nodiscard]] Image image_of(const Pixels& pixels, const std::optional<double>& exposure_stops);

/// Adds `Records` and `read_records` to the module.
void add_records(pybind11::module_& module);

}  // namespace postlens::python
