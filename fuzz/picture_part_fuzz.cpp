// Fuzzes the reader of parts of pictures.
#include "core/error.h"
#include "fuzz/fuzz_file.h"
#include "pictures/picture_part.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        const std::filesystem::path path = postlens::fuzz_file(data, size, ".exr");
        const auto part = postlens::read_picture_part(path);
        if (part && part->whole.width * static_cast<std::int64_t>(part->whole.height) <= 1 << 20) {
            postlens::Image whole(part->whole.width, part->whole.height);
            whole.alpha.resize(part->image.alpha.empty() ? 0 : whole.rgb.size() / 3);
            for (const auto& p : part->image.planes)
                whole.planes.push_back({p.name, std::vector<float>(whole.rgb.size() / 3)});
            postlens::paste(*part, "part", whole);
        }
    } catch (const postlens::Error&) {
        // The reader may refuse the input.
    }
    return 0;
}
