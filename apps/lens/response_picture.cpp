#include "apps/lens/response_picture.h"

#include <string>
#include <vector>

#include "core/files/output_file.h"
#include "pictures/exr/flat_exr.h"
#include "pictures/image.h"

namespace postlens {

void write_response(const std::filesystem::path& path, const ResponseGrid& grid) {
    check_exr_path(path, "responses");
    OutputFile file(path);
    const std::vector<float> values(grid.share.begin(), grid.share.end());
    FlatExr exr;
    exr.display = exr.data = {0, 0, grid.width - 1, grid.height - 1};
    exr.channels = {{"Y", ExrChannel::Type::float32, values.data()}};
    exr.pixel_bytes = sizeof(float);
    exr.row_bytes = exr.pixel_bytes * static_cast<std::size_t>(grid.width);
    exr.compression = ChunkCompression::zip;
    write_flat_exr(file.temporary_path(), path.string(), exr);
    file.commit();
}

}  // namespace postlens
