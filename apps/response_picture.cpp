#include "apps/response_picture.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/output_file.h"

namespace postlens {
namespace {

void write_bytes(OutputFile& file, const void* bytes, std::size_t count) {
    std::FILE* out = std::fopen(file.temporary_path().c_str(), "wb");
    bool ok = out != nullptr && std::fwrite(bytes, 1, count, out) == count;
    int error = errno;
    if (out != nullptr && std::fclose(out) != 0 && ok) {
        ok = false;
        error = errno;
    }
    if (!ok)
        fail(ExitCode::cannot_write, "{}: cannot write ({})", file.target().string(), std::strerror(error));
    file.commit();
}

}  // namespace

void check_response_path(const std::filesystem::path& path) {
    if (path.extension() == ".exr") return;
    fail(ExitCode::wrong_arguments, "{}: responses are written as OpenEXR (got ending \"{}\"; expected .exr)",
         path.string(), path.extension().string());
}

void write_response(const std::filesystem::path& path, const ResponseGrid& grid) {
    check_response_path(path);
    OutputFile file(path);
    OIIO::ImageSpec spec(grid.width, grid.height, 1, OIIO::TypeDesc::FLOAT);
    spec.channelnames = {"Y"};
    spec["oiio:ColorSpace"] = "Linear";
    spec["compression"] = "zip";
    spec["DateTime"] = "";  // equal responses are equal files
    const std::vector<float> values(grid.share.begin(), grid.share.end());
    // Written in memory first: on a full disk OpenImageIO does not always say so.
    OIIO::Filesystem::IOVecOutput memory;
    const auto out = OIIO::ImageOutput::create("response.exr", &memory);
    if (!out || !out->open("response.exr", spec) || !out->write_image(OIIO::TypeDesc::FLOAT, values.data()) ||
        !out->close()) {
        fail(ExitCode::cannot_write, "{}: cannot write ({})", path.string(),
             out ? out->geterror() : OIIO::geterror());
    }
    write_bytes(file, memory.buffer().data(), memory.buffer().size());
}

void write_table(const std::filesystem::path& path, const std::string& text) {
    OutputFile file(path);
    write_bytes(file, text.data(), text.size());
}

}  // namespace postlens
