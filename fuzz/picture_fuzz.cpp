#include "core/error.h"
#include "fuzz/fuzz_file.h"
#include "pictures/image.h"

// The extension is always .png, because the reader of an image is chosen by the file's content.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        (void)postlens::read_image(postlens::fuzz_file(data, size, ".png"));
    } catch (const postlens::Error&) {
        // The reader may refuse the input.
    }
    return 0;
}
