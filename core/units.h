#pragma once

namespace postlens {

inline constexpr double metres_per_mm = 1e-3;

}  // namespace postlens
