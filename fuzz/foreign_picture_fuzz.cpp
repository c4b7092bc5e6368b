// Fuzzes the reader of flat and deep OpenEXR images of other programs. Every part of the file is read.
#include <cmath>
#include <cstdlib>

#include "core/error.h"
#include "fuzz/fuzz_file.h"
#include "pictures/foreign/foreign_file.h"
#include "pictures/foreign/foreign_picture.h"
#include "pictures/stacks/unmix_edges.h"

namespace {

// Aborts if an accepted picture is not valid: offsets in range, finite colours, alphas and shares
// from 0 to 1.
void check(const postlens::ForeignPicture& picture) {
    if (picture.offsets.back() != picture.samples.size()) std::abort();
    for (const postlens::StackSample& s : picture.samples) {
        if (!std::isfinite(s.r) || !std::isfinite(s.g) || !std::isfinite(s.b)) std::abort();
        if (!(s.alpha >= 0 && s.alpha <= 1) || !(s.inverse_z >= 0)) std::abort();
    }
    for (const postlens::MixedPixel& m : picture.mixed) {
        if (m.pixel + 1 >= picture.offsets.size() || m.first + m.count > picture.shares.size()) std::abort();
    }
    for (const postlens::SurfaceShare& s : picture.shares) {
        if (!(s.share > 0 && s.share <= 1)) std::abort();
    }
    // A large frame with few samples is valid. Flattening one is skipped, because it would need much memory.
    if (static_cast<std::int64_t>(picture.width) * picture.height <= 1 << 24) (void)picture.flattened();
    if (picture.stores(0, 0)) (void)picture.depth_at(0.5, 0.5);
}

void read(const std::filesystem::path& path, const postlens::ForeignChoice& choice) {
    try {
        postlens::ForeignPicture picture = postlens::read_foreign_picture(path, choice, {});
        check(picture);
        if (picture.channels.matte) (void)postlens::manifest_names(picture.channels.matte->manifest);
        // The picture must still be valid after pixels with several surfaces are unmixed.
        if (postlens::unmix_edges(picture) > 0) check(picture);
    } catch (const postlens::Error&) {
        // The reader may refuse the input.
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto path = postlens::fuzz_file(data, size, ".exr");
    read(path, {});
    try {
        const postlens::ForeignFile file(path);
        for (const postlens::ForeignPart& part : file.parts()) {
            if (!part.name.empty()) read(path, {.layer = part.name});
        }
    } catch (const postlens::Error&) {
        // The reader may refuse the input.
    }
    return 0;
}
