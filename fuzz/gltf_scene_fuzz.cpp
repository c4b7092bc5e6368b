#include "core/error.h"
#include "fuzz/fuzz_file.h"
#include "scene/scene.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        (void)postlens::read_scene(postlens::fuzz_file(data, size, ".glb"));
    } catch (const postlens::Error&) {
        // The reader may refuse the input.
    }
    return 0;
}
