#include "core/error.h"
#include "fuzz/fuzz_file.h"
#include "scene/scene.h"

// The first byte chooses the format: OBJ if it is even, PLY if it is odd.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    try {
        (void)postlens::read_scene(
            postlens::fuzz_file(data + 1, size - 1, data[0] % 2 == 0 ? ".obj" : ".ply"));
    } catch (const postlens::Error&) {
        // The reader may refuse the input.
    }
    return 0;
}
