#include "core/error.h"
#include "fuzz/fuzz_file.h"
#include "records/image.h"

// By content: which reader gets a picture does not depend on its ending.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        (void)postlens::read_image(postlens::fuzz_file(data, size, ".png"));
    } catch (const postlens::Error&) {
        // Refused, as it may be.
    }
    return 0;
}
