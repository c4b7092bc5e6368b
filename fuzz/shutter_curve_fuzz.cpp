#include <cstdlib>

#include "core/error.h"
#include "fuzz/fuzz_file.h"
#include "lens/shutter_curve.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        const auto curve = postlens::ShutterCurve::read(postlens::fuzz_file(data, size, ".txt"));
        // An accepted curve must give instants within the open time, in ascending order.
        double before = 0;
        for (int i = 0; i <= 64; ++i) {
            const double time = curve.time(i / 64.0);
            if (!(time >= before && time <= 1)) std::abort();
            before = time;
        }
    } catch (const postlens::Error&) {
        // The reader may refuse the input.
    }
    return 0;
}
