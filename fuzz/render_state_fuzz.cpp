#include "core/error.h"
#include "fuzz/fuzz_file.h"
#include "tracer/distributed/render_state.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        postlens::RenderState state(4, 3, 1);
        postlens::read_state(postlens::fuzz_file(data, size, ".exr"), "settings", state);
    } catch (const postlens::Error&) {
        // The reader may refuse the input.
    }
    return 0;
}
