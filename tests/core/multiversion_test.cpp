// Kernels compiled for several instruction sets round alike.
#include "core/multiversion.h"

#include <cmath>
#include <cstddef>
#include <gtest/gtest.h>
#include <vector>

namespace postlens::test::multiversion_test {
namespace {

POSTLENS_MULTIVERSION void multiply_add(const float* a, const float* b, float* sum, int count) {
    for (int i = 0; i < count; ++i) sum[i] = sum[i] + a[i] * b[i];
}

TEST(Multiversion, RoundsAsTheBaseInstructionSetDoes) {
    std::vector<float> a(1001), b(1001), sum(1001), expected(1001);
    for (std::size_t i = 0; i < a.size(); ++i) {
        a[i] = 1.0F + static_cast<float>(i) * 1.1e-3F;
        b[i] = 1.0F / a[i];
        sum[i] = -1.0F;
        // The volatile variable forces the product to be rounded, so that the compiler cannot fuse it.
        const volatile float product = a[i] * b[i];
        expected[i] = sum[i] + product;
    }
    // At least one product must be inexact: otherwise a fused operation would give the same results.
    std::size_t fused_differs = 0;
    for (std::size_t i = 0; i < a.size(); ++i) fused_differs += std::fma(a[i], b[i], sum[i]) != expected[i];
    EXPECT_GT(fused_differs, 0U);
    multiply_add(a.data(), b.data(), sum.data(), static_cast<int>(sum.size()));
    EXPECT_EQ(sum, expected);
}

}  // namespace
}  // namespace postlens::test::multiversion_test
