#include "core/error.h"
#include "fuzz/fuzz_file.h"
#include "motionblur/paths/paths_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        const auto paths = postlens::read_paths(postlens::fuzz_file(data, size, ".toml"));
        (void)postlens::resolve_ids(paths, {{1, "wheel"}, {2, "wheel"}, {3, "post"}});
        for (const auto& path : paths)
            if (const auto* on_raster = std::get_if<postlens::ScreenPath>(&path.motion))
                (void)on_raster->flatten(0, 1, 1);
    } catch (const postlens::Error&) {
        // The reader may refuse the input.
    }
    return 0;
}
