#include "apps/response_picture.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/output_file.h"
#include "records/image.h"

namespace postlens {

void write_response(const std::filesystem::path& path, const ResponseGrid& grid) {
    check_exr_path(path, "responses");
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
    file.write({reinterpret_cast<const char*>(memory.buffer().data()), memory.buffer().size()});
    file.commit();
}

}  // namespace postlens
