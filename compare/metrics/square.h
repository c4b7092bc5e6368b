#pragma once

namespace postlens {

constexpr double square(double v) {
    return v * v;
}

}  // namespace postlens
