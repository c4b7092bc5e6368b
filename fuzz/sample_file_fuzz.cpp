#include <algorithm>

#include "core/error.h"
#include "fuzz/fuzz_file.h"
#include "records/sample_file.h"

namespace {

void read(const std::filesystem::path& path, postlens::Damage damage) {
    try {
        const postlens::SampleFileReader file(path, damage);
        postlens::RecordBand band;
        for (std::size_t instant = 0; instant < file.instants(); ++instant) {
            for (int y = file.y_begin(); y < file.y_end(); y += 16) {
                file.read(y, std::min(y + 16, file.y_end()), band, instant);
            }
        }
        (void)file.picture();
    } catch (const postlens::Error&) {
        // The reader may refuse the input.
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto path = postlens::fuzz_file(data, size, ".exr");
    read(path, postlens::Damage::refuse);
    read(path, postlens::Damage::salvage);
    return 0;
}
