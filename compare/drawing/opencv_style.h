#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace postlens {

/// The typeface of all text that OpenCV draws.
inline constexpr int font = cv::FONT_HERSHEY_SIMPLEX;

inline cv::Scalar scalar(const std::array<std::uint8_t, 3>& c) {
    return {static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2])};
}

}  // namespace postlens
