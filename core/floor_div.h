// Integer division that rounds down, also for negative numbers.
#pragma once

namespace postlens {

/// a / b, rounded down, for b > 0.
[[nodiscard]] constexpr int floor_div(int a, int b) {
    return a >= 0 ? a / b : -((-a + b - 1) / b);
}

}  // namespace postlens
