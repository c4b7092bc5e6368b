#include "postlens/picture.h"

#include "pictures/image.h"
#include "postlens/internals.h"

namespace postlens::api {

Picture load_picture(const std::filesystem::path& path, Job* job) {
    return guarded(job, [&] { return picture_of(read_image(path)); });
}

void save_picture(const std::filesystem::path& path, const Picture& picture, Job* job) {
    guarded(job, [&] {
        check_image_path(path);
        write_image(path, image_of(picture));
    });
}

}  // namespace postlens::api
